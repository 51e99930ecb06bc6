// SPDX-License-Identifier: BSD-3-Clause
// Promised and observed values of a knob, one setting at a time. An observation beyond its promise breaks it.
#pragma once

#include "report/experiment.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

/// printf for cells and sentences.
template <typename... Values> std::string text( const char* format, Values... values )
{
	const int length = std::snprintf( nullptr, 0, format, values... );
	std::string out( static_cast<std::size_t>( std::max( length, 0 ) ) + 1, '\0' );
	std::snprintf( out.data(), out.size(), format, values... );
	out.pop_back(); // the end of C
	return out;
}

/// One setting of a knob.
class Promise
{
public:
	/// @param granted rounding that an observation may exceed the promise by
	explicit Promise( double granted ) : m_granted( granted ) {}

	/// One answer: its promised and its observed value. A NaN is beyond every promise.
	/// @param what happened, kept for the first answer that breaks the promise
	void observe( double observed, double promised, const std::string& what )
	{
		++m_count;
		m_sum += observed;
		const bool kept = observed <= promised + m_granted;
		if ( !kept && m_broken++ == 0 )
		{
			m_first = text( "%.9g observed, %.9g promised: ", observed, promised ) + what;
		}
		m_worst = kept || std::isfinite( observed ) ? std::max( m_worst, observed ) : INFINITY;
		m_promised = std::max( m_promised, promised );
		m_share = promised > 0 && observed > 0 ? std::max( m_share, observed / promised ) : m_share;
	}

	std::size_t count() const { return m_count; }
	std::size_t broken() const { return m_broken; }
	double worst() const { return m_worst; }
	double share() const { return m_share; }       ///< the most that any answer used of its promise
	double promised() const { return m_promised; } ///< the largest of any answer
	double mean() const { return m_count > 0 ? m_sum / static_cast<double>( m_count ) : 0; }
	const std::string& first() const { return m_first; }

private:
	double m_granted;
	std::size_t m_count = 0, m_broken = 0;
	double m_worst = 0, m_promised = 0, m_sum = 0, m_share = 0;
	std::string m_first;
};

/// The most that any answer used of its promise.
inline double worstShare( const std::vector<const Promise*>& promises )
{
	double worst = 0;
	for ( const Promise* promise : promises )
	{
		worst = std::max( worst, promise->share() );
	}
	return worst;
}

/// The promises of all settings of a knob as a claim. Without a single observation it is broken too.
inline Claim claimOf( const std::string& what, const std::vector<const Promise*>& promises, const std::string& figure )
{
	Claim claim{ "promise", what, figure, Verdict::HOLDS, "" };
	std::size_t count = 0, broken = 0;
	for ( const Promise* promise : promises )
	{
		count += promise->count();
		broken += promise->broken();
		claim.why = claim.why.empty() ? promise->first() : claim.why;
	}
	claim.figure = text( "%zu answers, %zu beyond it; ", count, broken ) + figure;
	if ( broken > 0 || count == 0 )
	{
		claim.verdict = Verdict::BROKEN;
		claim.why = count == 0 ? "nothing was observed" : claim.why;
	}
	return claim;
}
