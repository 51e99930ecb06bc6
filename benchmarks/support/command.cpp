// SPDX-License-Identifier: BSD-3-Clause
// The subcommands of leeway-bench: see command.hpp. CLI11 is compiled here once for all of them, for it takes longer than they do.
#include "support/command.hpp"

#include <CLI/CLI.hpp>

#include <cstdio>
#include <filesystem>
#include <sstream>

struct Command::Parts
{
	template <typename T> CLI::Option& add( const std::string& option, T& value, const std::string& help )
	{
		return *app->add_option( option, value, help )->capture_default_str();
	}

	template <typename T> void add( const std::string& option, T& value, const std::string& help, Between<T> allowed );

	CLI::App* app = nullptr;
	std::string json, csv;
	std::function<int()> work;
};

struct Bench::Parts
{
	CLI::App app{ "leeway's benchmarks and audits.", "leeway-bench" };
	std::vector<std::unique_ptr<Command>> commands;
};

namespace
{

template <typename T> std::string describe( Between<T> allowed )
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
void Command::Parts::add( const std::string& option, T& value, const std::string& help, Between<T> allowed )
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

Command::Command() : m_parts( std::make_unique<Parts>() ) {}

Command::~Command() = default;

void Command::option( const std::string& name, std::string& value, const std::string& help )
{
	m_parts->add( name, value, help );
}

void Command::option( const std::string& name, std::vector<std::string>& values, const std::string& help )
{
	m_parts->add( name, values, help );
}

void Command::option( const std::string& name, std::vector<double>& values, const std::string& help )
{
	m_parts->add( name, values, help ).delimiter( ',' );
}

void Command::option( const std::string& name, int& value, const std::string& help, Between<int> allowed )
{
	m_parts->add( name, value, help, allowed );
}

void Command::option( const std::string& name, unsigned& value, const std::string& help, Between<unsigned> allowed )
{
	m_parts->add( name, value, help, allowed );
}

void Command::option(
    const std::string& name, std::uint64_t& value, const std::string& help, Between<std::uint64_t> allowed )
{
	m_parts->add( name, value, help, allowed );
}

void Command::option( const std::string& name, double& value, const std::string& help, Between<double> allowed )
{
	m_parts->add( name, value, help, allowed );
}

void Command::inputFile( const std::string& name, std::string& value, const std::string& help )
{
	m_parts->add( name, value, help ).check( CLI::ExistingFile );
}

void Command::flag( const std::string& name, bool& value, const std::string& help )
{
	m_parts->app->add_flag( name, value, help );
}

namespace
{

/// The values of all options, given or not. Of files and folders the last name: paths differ between machines.
Json valuesOf( const CLI::App& app )
{
	Json values = Json::object();
	for ( const CLI::Option* option : app.get_options() )
	{
		const std::string name = option->get_name();
		if ( name == "--help" || name == "--json" || name == "--csv" )
		{
			continue;
		}
		std::string text;
		for ( const std::string& given : option->results() )
		{
			text += ( text.empty() ? "" : " " ) + given.substr( given.find_last_of( '/' ) + 1 );
		}
		const std::string usual = option->get_default_str();
		values[name] = option->count() > 0 ? text : usual.substr( usual.find_last_of( '/' ) + 1 );
	}
	return values;
}

} // namespace

void Command::work( std::function<int( Result& )> work )
{
	m_parts->app->add_option( "--json", m_parts->json, "write rows and where they come from to this file" );
	m_parts->app->add_option( "--csv", m_parts->csv, "write the rows to this file" );
	m_parts->work = [this, work = std::move( work )]
	{
		Result result( m_parts->app->get_name() );
		result["options"] = valuesOf( *m_parts->app );
		std::printf( "%s\n", result.origin().c_str() );
		const int status = work( result );
		result.writeJson( m_parts->json );
		result.writeCsv( m_parts->csv );
		return status;
	};
}

void Command::work( std::function<int()> work )
{
	m_parts->work = std::move( work );
}

Bench::Bench() : m_parts( std::make_unique<Parts>() )
{
	m_parts->app.require_subcommand( 1 );
	m_parts->app.footer( "leeway-bench COMMAND --help tells the options of a command.\n"
	                     "Exit status: 0; 1 if what was measured is wrong; 2 after an error; 77 if there is no data." );
}

Bench::~Bench() = default;

Command& Bench::command( const std::string& name, const std::string& about )
{
	m_parts->commands.push_back( std::make_unique<Command>() );
	Command& command = *m_parts->commands.back();
	command.m_parts->app = m_parts->app.add_subcommand( name, about );
	return command;
}

int Bench::run( int argc, char** argv )
{
	CLI11_PARSE( m_parts->app, argc, argv );
	int status = 2;
	std::string why;
	const CLI::App* chosen = m_parts->app.get_subcommands().front();
	try
	{
		for ( const std::unique_ptr<Command>& command : m_parts->commands )
		{
			if ( command->m_parts->app == chosen )
			{
				return command->m_parts->work();
			}
		}
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
	std::fprintf( stderr, "leeway-bench %s: error: %s\n", chosen->get_name().c_str(), why.c_str() );
	return status;
}
