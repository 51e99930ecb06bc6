// SPDX-License-Identifier: BSD-3-Clause
// Judging of answers: see peer_judge.hpp.
#include "peers/peer_judge.hpp"

#include "support/provenance.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace
{

ConfigurationSet numbers( std::size_t count )
{
	ConfigurationSet set;
	for ( std::size_t i = 0; i < count; ++i )
	{
		set.states.push_back( { static_cast<double>( i ) } );
	}
	return set;
}

std::string explain( const Asked& asked, const Truth& truth, double by, bool too_far )
{
	char text[160];
	if ( too_far && asked.shape_error > 0 && by <= asked.shape_error )
	{
		std::snprintf( text, sizeof text, "%.2g m too far: its polyhedra lie up to %.2g m inside of round shapes", by,
		    asked.shape_error );
	}
	else if ( too_far && !asked.has_solids && truth.is_solid && truth.upper <= 0 )
	{
		return "it knows surfaces only, and one shape lies inside of the other: " + truth.kinds;
	}
	else if ( !std::isfinite( by ) )
	{
		return "a contact that it does not see: " + truth.kinds;
	}
	else
	{
		std::snprintf( text, sizeof text, "%.2g m too %s: %s", by, too_far ? "far" : "near", truth.kinds.c_str() );
	}
	return text;
}

} // namespace

std::vector<std::size_t> where( const std::vector<double>& truth, const std::function<bool( double )>& holds )
{
	std::vector<std::size_t> members;
	for ( std::size_t i = 0; i < truth.size(); ++i )
	{
		if ( holds( truth[i] ) )
		{
			members.push_back( i );
		}
	}
	return members;
}

void Trial::run( std::size_t count, int repetitions, std::vector<double> truth )
{
	std::vector<Contender> contenders;
	for ( const Asked& asked : m_asked )
	{
		contenders.push_back( asked.contender );
	}
	m_runs = race( contenders, numbers( count ), repetitions, BLOCK );
	m_truth = std::move( truth );
	for ( std::size_t i = m_truth.size(); i < count; ++i )
	{
		m_truth.push_back( m_runs[0].answers[i].upper );
	}
	m_examined.clear();
}

Trial::Wrong Trial::judge( std::size_t contender, std::size_t member, const Truth& truth ) const
{
	const Answer& got = m_runs[contender].answers[member];
	const Asked& asked = m_asked[contender];
	Wrong wrong;
	const bool missed = m_question.verdict && got.upper <= 0 && truth.upper <= m_question.margin;
	if ( m_question.verdict )
	{
		const bool invented = got.upper > 0 && truth.lower > m_question.margin;
		wrong.by = missed && truth.upper <= 0 && m_question.margin <= 0 ? INFINITE
		           : missed                                             ? m_question.margin - truth.upper
		           : invented                                           ? truth.lower - m_question.margin
		                                                                : 0;
	}
	else
	{
		const double most = contender == 0 ? got.lower : got.upper / ( 1 + m_question.relativeError() );
		wrong.by = std::max( { 0.0, truth.lower - got.upper, most - truth.upper } );
	}
	if ( wrong.by > AGREEMENT )
	{
		wrong.why = explain( asked, truth, wrong.by, missed || ( !m_question.verdict && got.upper > truth.upper ) );
	}
	return wrong;
}

Truth Trial::truthOf( std::size_t member )
{
	const auto found = m_examined.find( member );
	if ( found != m_examined.end() )
	{
		return found->second;
	}
	Truth truth;
	truth.lower = truth.upper = m_truth[member];
	double largest = truth.upper;
	bool doubted = false;
	for ( std::size_t c = 0; c < m_asked.size(); ++c )
	{
		doubted = doubted || judge( c, member, truth ).by > AGREEMENT;
		largest = std::max( largest, m_question.verdict ? m_question.margin : m_runs[c].answers[member].upper );
	}
	if ( doubted )
	{
		truth = m_brute( member, largest + 10 * AGREEMENT );
		m_examined[member] = truth;
	}
	return truth;
}

void Trial::report( PeerReport& out, const std::string& workload, const std::vector<std::size_t>& members, bool judged )
{
	if ( members.empty() )
	{
		return;
	}
	std::vector<PeerRow> rows;
	for ( std::size_t c = 0; c < m_asked.size(); ++c )
	{
		PeerRow row;
		row.workload = workload;
		row.library = m_asked[c].contender.name;
		row.count = members.size();
		std::vector<double> times;
		Hash hash;
		for ( const std::size_t i : members )
		{
			const Answer& answer = m_runs[c].answers[i];
			times.push_back( m_runs[c].microseconds[i] );
			hash.add( std::isfinite( answer.upper ) ? std::llround( answer.upper * 1e9 ) : -1 );
			if ( !judged )
			{
				continue;
			}
			const Truth truth = truthOf( i );
			const Wrong wrong = judge( c, i, truth );
			if ( wrong.by > AGREEMENT )
			{
				++row.disagreements;
				row.largest_difference =
				    std::isfinite( wrong.by ) ? std::max( row.largest_difference, wrong.by ) : row.largest_difference;
				Disagreement entry;
				entry.number = i;
				entry.said = answer.upper;
				entry.leeway = m_runs[0].answers[i].upper;
				entry.lower = truth.lower;
				entry.upper = truth.upper;
				entry.why = wrong.why;
				row.examined.push_back( entry );
			}
		}
		row.time = summarise( times );
		row.answers_hash = hash.text();
		rows.push_back( row );
	}
	out.add( rows );
}
