// SPDX-License-Identifier: BSD-3-Clause
// Counts to time, the Pareto front, and the choice on it. Nothing here looks at a clock.
#include "leeway/tune/tune.hpp"

#include <algorithm>
#include <tuple>
#include <utility>

namespace leeway::cli
{
namespace
{

// Accuracy given up without a target: a hundredth of the asked max_d, and a millimetre for motions (as by the default
// slack).
constexpr double usual_error = 0.01, usual_conservatism = 0.00112;
// A setting that calls fewer of the free states or motions free is fast, and of no use to a planner.
constexpr double kept = 0.9;
// Work this close is the same: for less nothing is given up.
constexpr double even = 1.02, close = 1.05;

// Is `a` as good as `b` in all of it, and better in something? (No two rows can be so to each other: work alone decides
// strictly.)
bool dominates( const TuneRow& a, const TuneRow& b )
{
	const bool as_good = a.work <= b.work * even && a.promised <= b.promised && a.proof >= b.proof && a.free >= b.free;
	return as_good && ( a.work < b.work || a.promised < b.promised || a.proof > b.proof || a.free > b.free );
}

enum class Wish
{
	CHEAP, // the least work
	FINE   // the best promise, then the least work
};

// A proposed setting proves, keeps most states free, and works for all users: the OMPL shim and `plan` prove motions with
// the default alpha.
bool isPossible( const TuneRow& row, const TuneSamples& samples )
{
	const double all = double( row.motion ? samples.free_motions : samples.free_states );
	const bool certified = row.motion && row.method == LW_EDGE_CERTIFIED;
	return row.proof && double( row.free ) >= kept * all && ( !certified || row.alpha == lw_edge_def_default().alpha );
}

// The best row of those that pass and are possible; of those with nearly its work the one that gives up least. nullptr if
// none passes.
template <typename Passes>
const TuneRow* best( const std::vector<TuneRow>& rows, const TuneSamples& samples, Wish wish, const Passes& passes )
{
	const auto key = [wish]( const TuneRow& row )
	{ return std::make_pair( wish == Wish::FINE ? row.promised : 0, row.work ); };
	const auto given = []( const TuneRow& row ) { return std::make_tuple( row.min_d, row.promised, row.work ); };
	const TuneRow* first = nullptr;
	for ( const TuneRow& row : rows )
	{
		if ( isPossible( row, samples ) && passes( row ) && ( first == nullptr || key( row ) < key( *first ) ) )
		{
			first = &row;
		}
	}
	const TuneRow* found = first;
	for ( const TuneRow& row : rows )
	{
		if ( first != nullptr && isPossible( row, samples ) && passes( row ) && key( row ).first <= key( *first ).first &&
		     row.work <= close * first->work && given( row ) < given( *found ) )
		{
			found = &row;
		}
	}
	return found;
}

// The setting of a kind without a target, at one min_d: the cheapest within the usual error, else the most accurate.
const TuneRow* usual( const std::vector<TuneRow>& rows, const TuneSamples& samples, bool motion, double min_d )
{
	const TuneRow& asked = rows.front(); // exact
	const double limit = min_d - asked.min_d + ( motion ? usual_conservatism : usual_error * asked.max_d );
	const auto same = [=]( const TuneRow& row ) { return row.motion == motion && row.min_d == min_d; };
	const TuneRow* found =
	    best( rows, samples, Wish::CHEAP, [&]( const TuneRow& row ) { return same( row ) && row.promised <= limit; } );
	return found != nullptr ? found : best( rows, samples, Wish::FINE, same );
}

} // namespace

void markFront( std::vector<TuneRow>& rows )
{
	for ( TuneRow& row : rows )
	{
		row.front = std::none_of( rows.begin(), rows.end(),
		    [&]( const TuneRow& other ) { return other.motion == row.motion && dominates( other, row ); } );
	}
}

TuneProposal propose( const std::vector<TuneRow>& rows, const TuneSamples& samples, const TuneTarget& target, double rate )
{
	const bool motion = target.kind == TuneTarget::CONSERVATISM, by_time = target.kind == TuneTarget::TIME;
	const auto meets = [&]( const TuneRow& row )
	{ return row.motion == motion && ( by_time ? row.work * rate : row.promised ) <= target.value; };
	TuneProposal proposal;
	const TuneRow* first = target.kind == TuneTarget::NONE
	                           ? usual( rows, samples, false, rows.front().min_d )
	                           : best( rows, samples, by_time ? Wish::FINE : Wish::CHEAP, meets );
	proposal.met = first != nullptr;
	if ( first == nullptr ) // the nearest to the target
	{
		first = best(
		    rows, samples, by_time ? Wish::CHEAP : Wish::FINE, [=]( const TuneRow& row ) { return row.motion == motion; } );
		proposal.best = first == nullptr ? 0 : by_time ? first->work * rate : first->promised;
	}
	if ( first != nullptr )
	{
		const TuneRow* second = usual( rows, samples, !first->motion, first->min_d );
		proposal.states = first->motion ? second : first;
		proposal.motions = first->motion ? first : second;
	}
	return proposal;
}

} // namespace leeway::cli
