// SPDX-License-Identifier: BSD-3-Clause
// How far a run is: see console_progress.hpp.
#include "report/console_progress.hpp"

#include <cmath>
#include <cstdio>
#include <unistd.h>

namespace
{

constexpr double ENOUGH = 0.05; ///< share of a piece after which its own pace is believed
constexpr double PATIENCE = 1;  ///< seconds before the first line, and between two on a terminal at least a tenth of it
constexpr double INTERVAL = 10; ///< seconds between lines where there is no terminal

} // namespace

void TimeLeft::begin( std::size_t i, double now )
{
	m_first = i == 0 ? now : m_first;
	m_piece = i;
	m_began = now;
}

double TimeLeft::rest() const
{
	double sum = 0;
	for ( std::size_t i = m_piece + 1; i < m_expected.size(); ++i )
	{
		sum += m_expected[i];
	}
	return sum;
}

double TimeLeft::pace( double share, double now ) const
{
	double expected = share * m_expected[m_piece];
	for ( std::size_t i = 0; i < m_piece; ++i )
	{
		expected += m_expected[i];
	}
	const bool known = m_piece > 0 || share >= ENOUGH;
	return known && expected > 0 ? ( now - m_first ) / expected : 1;
}

double TimeLeft::left( double share, double now ) const
{
	const double p = pace( share, now );
	const double mine =
	    share >= ENOUGH ? ( now - m_began ) * ( 1 - share ) / share : ( 1 - share ) * m_expected[m_piece] * p;
	return mine + rest() * p;
}

double TimeLeft::done( double share, double now ) const
{
	const double taken = now - m_first;
	return taken > 0 ? taken / ( taken + left( share, now ) ) : 0;
}

std::string sayDuration( double seconds )
{
	const long whole = std::lround( seconds );
	const std::string rest = std::to_string( whole % 60 ) + " s";
	return whole < 60 ? rest : std::to_string( whole / 60 ) + " min " + rest;
}

ConsoleProgress::ConsoleProgress( std::vector<double> expected )
    : m_time( std::move( expected ) ), m_terminal( isatty( STDERR_FILENO ) != 0 )
{
}

ConsoleProgress::~ConsoleProgress()
{
	clear();
}

double ConsoleProgress::now() const
{
	return std::chrono::duration<double>( std::chrono::steady_clock::now() - m_start ).count();
}

void ConsoleProgress::clear() const
{
	if ( m_terminal && m_said > 0 )
	{
		std::fprintf( stderr, "\r\033[K" );
	}
}

void ConsoleProgress::begin( std::size_t i, const std::string& name )
{
	m_time.begin( i, now() );
	m_name = name;
}

void ConsoleProgress::at( double share, const std::string& what )
{
	const double time = now();
	if ( time < PATIENCE || ( m_said > 0 && time - m_said < ( m_terminal ? 0.1 * PATIENCE : INTERVAL ) ) )
	{
		return;
	}
	m_said = time;
	std::fprintf( stderr, "%s%3.0f %%, %s left: %s, %s%s", m_terminal ? "\r\033[K" : "", 100 * m_time.done( share, time ),
	    sayDuration( m_time.left( share, time ) ).c_str(), m_name.c_str(), what.c_str(), m_terminal ? "" : "\n" );
	std::fflush( stderr );
}
