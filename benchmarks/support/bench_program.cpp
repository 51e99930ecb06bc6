// SPDX-License-Identifier: BSD-3-Clause
// The benchmarks' command lines: see bench_program.hpp. CLI11 is compiled here once for all of them, for it takes longer
// than they do.
#include "support/bench_program.hpp"

#include <CLI/CLI.hpp>

#include <cstdio>
#include <filesystem>
#include <sstream>

struct BenchProgram::Parts
{
	explicit Parts( const std::string& about, const std::string& name ) : app( about, name ) {}

	template <typename T>
	CLI::Option& add( const std::string& option, T& value, const std::string& help )
	{
		return *app.add_option( option, value, help )->capture_default_str();
	}

	template <typename T>
	void add( const std::string& option, T& value, const std::string& help, Between<T> allowed );

	CLI::App app;
};

namespace
{

template <typename T>
std::string describe( Between<T> allowed )
{
	std::ostringstream out;
	if ( allowed.most < std::numeric_limits<T>::max() )
	{
		out << allowed.least << " to " << allowed.most;
	}
	else if ( std::is_floating_point_v<T> && allowed.least == std::numeric_limits<T>::min() )
	{
		out << "more than 0";
	}
	else if ( std::is_unsigned_v<T> || allowed.least > std::numeric_limits<T>::lowest() )
	{
		out << "at least " << allowed.least;
	}
	else
	{
		out << "a number";
	}
	return out.str();
}

} // namespace

template <typename T>
void BenchProgram::Parts::add( const std::string& option, T& value, const std::string& help, Between<T> allowed )
{
	CLI::Option& added = add( option, value, help );
	const std::string what = describe( allowed );
	const auto refuse = [allowed, what]( std::string& text )
	{
		T given;
		const bool is_negative = text.rfind( '-', 0 ) == 0; // which CLI11 wraps around
		const bool ok = ( std::is_signed_v<T> || !is_negative ) && CLI::detail::lexical_cast( text, given ) &&
						given >= allowed.least && given <= allowed.most;
		return ok ? std::string() : "'" + text + "' must be " + what;
	};
	added.check( CLI::Validator( refuse, "(" + what + ")" ) );
}

void requireData( const std::string& data, const std::string& folder )
{
	if ( !std::filesystem::exists( std::filesystem::path( data ) / folder ) )
	{
		throw NoData( data + ": no folder " + folder + " there; give the data folder with --data" );
	}
}

BenchProgram::BenchProgram( std::string name, const std::string& about )
    : m_parts( std::make_unique<Parts>(
          about + "\nExit status: 0; 1 if what was measured is wrong; 2 after an error; 77 if there is no data.",
          std::move( name ) ) )
{
}

BenchProgram::~BenchProgram() = default;

void BenchProgram::option( const std::string& name, std::string& value, const std::string& help )
{
	m_parts->add( name, value, help );
}

void BenchProgram::option( const std::string& name, std::vector<std::string>& values, const std::string& help )
{
	m_parts->add( name, values, help );
}

void BenchProgram::option( const std::string& name, std::vector<double>& values, const std::string& help )
{
	m_parts->add( name, values, help );
}

void BenchProgram::option( const std::string& name, int& value, const std::string& help, Between<int> allowed )
{
	m_parts->add( name, value, help, allowed );
}

void BenchProgram::option( const std::string& name, unsigned& value, const std::string& help, Between<unsigned> allowed )
{
	m_parts->add( name, value, help, allowed );
}

void BenchProgram::option(
    const std::string& name, std::uint64_t& value, const std::string& help, Between<std::uint64_t> allowed )
{
	m_parts->add( name, value, help, allowed );
}

void BenchProgram::option( const std::string& name, double& value, const std::string& help, Between<double> allowed )
{
	m_parts->add( name, value, help, allowed );
}

void BenchProgram::inputFile( const std::string& name, std::string& value, const std::string& help )
{
	m_parts->add( name, value, help ).check( CLI::ExistingFile );
}

void BenchProgram::flag( const std::string& name, bool& value, const std::string& help )
{
	m_parts->app.add_flag( name, value, help );
}

int BenchProgram::run( int argc, char** argv, const std::function<int()>& work )
{
	CLI11_PARSE( m_parts->app, argc, argv );
	int status = 2;
	std::string why;
	try
	{
		return work();
	}
	catch ( const NoData& error )
	{
		why = error.what();
		status = 77;
	}
	catch ( const std::exception& error )
	{
		why = error.what();
	}
	std::fprintf( stderr, "%s: error: %s\n", m_parts->app.get_name().c_str(), why.c_str() );
	return status;
}
