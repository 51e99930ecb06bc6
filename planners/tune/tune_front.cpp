// SPDX-License-Identifier: BSD-3-Clause
// Counts to time, the Pareto front, and the choice on it. Nothing here looks at a clock.
#include "leeway/tune/tune.hpp"

#include <algorithm>
#include <tuple>
#include <utility>

namespace leeway::tune
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
bool dominates( const Row& a, const Row& b )
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
bool isPossible( const Row& row, const Samples& samples )
{
	const double all = double( row.motion ? samples.free_motions : samples.free_states );
	const bool certified = row.motion && row.method == LW_EDGE_CERTIFIED;
	return row.proof && double( row.free ) >= kept * all && ( !certified || row.alpha == lw_edge_def_default().alpha );
}

// The best row of those that pass and are possible; of those with nearly its work the one that gives up least. nullptr if
// none passes.
template <typename Passes>
const Row* best( const std::vector<Row>& rows, const Samples& samples, Wish wish, const Passes& passes )
{
	const auto key = [wish]( const Row& row ) { return std::make_pair( wish == Wish::FINE ? row.promised : 0, row.work ); };
	const auto given = []( const Row& row ) { return std::make_tuple( row.min_d, row.promised, row.work ); };
	const Row* first = nullptr;
	for ( const Row& row : rows )
	{
		if ( isPossible( row, samples ) && passes( row ) && ( first == nullptr || key( row ) < key( *first ) ) )
		{
			first = &row;
		}
	}
	const Row* found = first;
	for ( const Row& row : rows )
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
const Row* usual( const std::vector<Row>& rows, const Samples& samples, bool motion, double min_d )
{
	const Row& asked = rows.front(); // exact
	const double limit = min_d - asked.min_d + ( motion ? usual_conservatism : usual_error * asked.max_d );
	const auto same = [=]( const Row& row ) { return row.motion == motion && row.min_d == min_d; };
	const Row* found =
	    best( rows, samples, Wish::CHEAP, [&]( const Row& row ) { return same( row ) && row.promised <= limit; } );
	return found != nullptr ? found : best( rows, samples, Wish::FINE, same );
}

} // namespace

void markFront( std::vector<Row>& rows )
{
	for ( Row& row : rows )
	{
		row.front = std::none_of( rows.begin(), rows.end(),
		    [&]( const Row& other ) { return other.motion == row.motion && dominates( other, row ); } );
	}
}

Proposal propose( const std::vector<Row>& rows, const Samples& samples, const Target& target, double rate )
{
	const bool motion = target.kind == Target::CONSERVATISM, by_time = target.kind == Target::TIME;
	const auto meets = [&]( const Row& row )
	{ return row.motion == motion && ( by_time ? row.work * rate : row.promised ) <= target.value; };
	Proposal proposal;
	const Row* first = target.kind == Target::NONE ? usual( rows, samples, false, rows.front().min_d )
	                                               : best( rows, samples, by_time ? Wish::FINE : Wish::CHEAP, meets );
	proposal.met = first != nullptr;
	if ( first == nullptr ) // the nearest to the target
	{
		first = best(
		    rows, samples, by_time ? Wish::CHEAP : Wish::FINE, [=]( const Row& row ) { return row.motion == motion; } );
		proposal.best = first == nullptr ? 0 : by_time ? first->work * rate : first->promised;
	}
	if ( first != nullptr )
	{
		const Row* second = usual( rows, samples, !first->motion, first->min_d );
		proposal.states = first->motion ? second : first;
		proposal.motions = first->motion ? first : second;
	}
	return proposal;
}

} // namespace leeway::tune
