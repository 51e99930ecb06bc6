// SPDX-License-Identifier: BSD-3-Clause
// Reasons of a search that found no path, measured and put into words.
#include "explain.hpp"
#include "space.hpp"
#include "tree.hpp"

#include <array>
#include <sstream>

namespace leeway::planners
{

namespace
{

constexpr int most_edges = 16;        // for one direction of a joint
constexpr double least_share = 0.005; // of the travel found so far, for one edge more

void sortByCount( std::vector<BlockingPair>& pairs )
{
	std::stable_sort(
	    pairs.begin(), pairs.end(), []( const BlockingPair& x, const BlockingPair& y ) { return x.count() > y.count(); } );
}

/// Proved free travel of variable i from q towards its bound. Each edge starts at the end of the part that the edge before it
/// proved (proved_until), since that part ends before the first state that is not free.
double measureTravel( const lw_checker* checker, lw_query* query, const lw_edge_def& def, const Space& space,
    const double* q, std::size_t i, bool up, Blame& blame )
{
	std::vector<double> target( q, q + space.size() );
	target[i] = space.wraps( i ) ? q[i] + ( up ? longest_turn : -longest_turn ) : up ? space.upper()[i] : space.lower()[i];
	const double way = std::fabs( target[i] - q[i] );
	space.normalise( target.data() );
	std::vector<double> from( q, q + space.size() );
	double travel = 0;
	for ( int edge = 0; way > 0 && edge < most_edges; ++edge )
	{
		lw_edge_result result;
		if ( lw_checker_edge( checker, query, from.data(), target.data(), &def, &result ) != LW_OK )
		{
			break;
		}
		if ( result.verdict == LW_VERDICT_FREE )
		{
			return way;
		}
		if ( edge == 0 )
		{
			blame.edge( result );
		}
		const double gain = result.proved_until * ( way - travel );
		travel += gain;
		if ( gain < least_share * travel || gain <= 0 )
		{
			break;
		}
		from[i] = q[i] + ( up ? travel : -travel );
		space.normalise( from.data() );
	}
	return travel;
}

} // namespace

EndRoom measureRoom( const lw_checker* checker, lw_query* query, const lw_edge_def& def, const Space& space, const double* q,
    Deadline& deadline )
{
	EndRoom room;
	room.state.assign( q, q + space.size() );
	room.down.assign( space.size(), 0.0 );
	room.up = room.down;
	Blame blame( space.size() );
	lw_edge_def edge = def;
	edge.want_proved_until = true;
	Statistics unused;
	room.free = Validator( checker, query, def, unused ).isStateFree( q );
	if ( !room.free )
	{
		blame.state( q );
	}
	double most = 0;
	for ( std::size_t i = 0; room.free && i < space.size() && !deadline.over(); ++i )
	{
		room.down[i] = measureTravel( checker, query, edge, space, q, i, false, blame );
		room.up[i] = measureTravel( checker, query, edge, space, q, i, true, blame );
		most = std::max( { most, room.down[i], room.up[i] } );
	}
	room.enclosed = room.free && deadline.outcome() == Outcome::SOLVED && most < enclosed_travel;
	Stop forever;
	Deadline none( forever );
	const std::vector<BlockingPair> pairs = measurePairs( checker, query, def, blame, none );
	room.pair = pairs.empty() ? BlockingPair() : pairs.front();
	return room;
}

std::vector<BlockingPair> measurePairs(
    const lw_checker* checker, lw_query* query, const lw_edge_def& def, const Blame& blame, Deadline& deadline )
{
	std::vector<BlockingPair> pairs = blame.pairs();
	for ( std::size_t i = 0; i < blame.keptCount() && !deadline.over(); ++i )
	{
		bool free = false;
		lw_state_reason reason;
		lw_checker_is_free( checker, query, blame.kept( i ), def.flags, def.min_d, &free, &reason );
		BlockingPair* pair = reason.pair.kind != LW_CLEARANCE_UNKNOWN
		                         ? Blame::find( pairs, reason.self, reason.pair.a, reason.pair.b )
		                         : nullptr;
		if ( pair != nullptr )
		{
			pair->states += blame.stride();
			pair->clearance = std::min( pair->clearance, reason.pair.upper );
		}
	}
	sortByCount( pairs );
	return pairs;
}

double extent( const Space& space, const Tree& tree )
{
	double most = 0;
	std::vector<std::uint32_t> root( tree.size() );
	for ( std::uint32_t i = 0; i < tree.size(); ++i ) // parents come before their children
	{
		root[i] = tree.parent( i ) == no_node ? i : root[tree.parent( i )];
		most = std::max( most, space.distance( tree.state( i ), tree.state( root[i] ) ) );
	}
	return most;
}

namespace
{

const char* const side_names[] = { "start", "goal" };
constexpr double stuck_share = 0.25;         // of the other tree's share of tries that grew, or of its extent
constexpr double main_share = 0.5;           // of all motions that were not free: a pair worth a look of its own
constexpr std::uint64_t least_evidence = 10; // such motions, before a remedy names a pair
constexpr std::size_t shown_pairs = 4, shown_joints = 4;

std::string shortNumber( double value )
{
	std::ostringstream text;
	text.precision( 3 );
	text << value;
	return text.str();
}

std::string percent( double share )
{
	std::ostringstream text;
	share >= 0.01 ? text << std::lround( 100 * share ) << " %" : text << "below 1 %";
	return text.str();
}

double grownShare( const TreeGrowth& tree )
{
	return tree.tries > 0 ? static_cast<double>( tree.grown ) / static_cast<double>( tree.tries ) : 1;
}

/// Side of a tree that grows much worse than the other; 2 if none does.
unsigned stuckSide( const Stuck& stuck )
{
	for ( unsigned side = 0; side < 2; ++side )
	{
		const TreeGrowth &one = stuck.trees[side], &other = stuck.trees[1 - side];
		if ( one.nodes > 0 && other.nodes > 0 &&
		     ( one.extent < stuck_share * other.extent || grownShare( one ) < stuck_share * grownShare( other ) ) )
		{
			return side;
		}
	}
	return 2;
}

std::string treeLine( const Stuck& stuck )
{
	if ( stuck.trees[0].nodes == 0 || stuck.trees[1].nodes == 0 )
	{
		return "";
	}
	const unsigned side = stuckSide( stuck );
	std::ostringstream text;
	text << "trees: "
	     << ( side < 2 ? std::string( "the " ) + side_names[side] + " tree is stuck" : "no tree is stuck near its end" );
	for ( unsigned i = 0; i < 2; ++i )
	{
		const TreeGrowth& tree = stuck.trees[i];
		text << "; " << side_names[i] << ": " << tree.nodes << ( tree.nodes == 1 ? " node, " : " nodes, " ) << tree.grown
		     << " of " << tree.tries << " tries grew, extent " << shortNumber( tree.extent );
	}
	text << "; least distance between them " << shortNumber( stuck.gap ) << "\n";
	return text.str();
}

std::string variableName( const lw_checker* checker, std::size_t i )
{
	const lw_variable_info info =
	    lw_robot_variable( lw_checker_robot( checker ), lw_checker_variable( checker, static_cast<std::uint32_t>( i ) ) );
	const bool planar = lw_robot_joint_type( lw_checker_robot( checker ), info.joint ) == LW_JOINT_PLANAR;
	const std::array<const char*, 3> parts = { "/x", "/y", "/theta" };
	return std::string( jointName( checker, i ) ) + ( planar && info.component < 3 ? parts[info.component] : "" );
}

/// The joints with the least free travel.
std::string tightJoints( const lw_checker* checker, const EndRoom& room )
{
	std::vector<std::size_t> order;
	for ( std::size_t i = 0; i < room.up.size(); ++i )
	{
		order.push_back( i );
	}
	std::stable_sort( order.begin(), order.end(),
	    [&]( std::size_t a, std::size_t b ) { return room.down[a] + room.up[a] < room.down[b] + room.up[b]; } );
	std::string text;
	for ( std::size_t k = 0; k < std::min( shown_joints, order.size() ); ++k )
	{
		const std::size_t i = order[k];
		text += ( k > 0 ? ", " : "" ) + variableName( checker, i ) + " -" + shortNumber( room.down[i] ) + " +" +
		        shortNumber( room.up[i] );
	}
	return text;
}

std::string stopper( const lw_checker* checker, const EndRoom& room, const char* verb )
{
	return room.pair.count() > 0 ? std::string( verb ) + pairName( checker, room.pair ) : "";
}

/// One line for the starts or the goals: the one with the worst state of affairs.
std::string endLine( const lw_checker* checker, const std::vector<EndRoom>& rooms, unsigned side )
{
	const EndRoom* worst = nullptr;
	const auto rank = []( const EndRoom& room ) { return room.free ? ( room.enclosed ? 1 : 2 ) : 0; };
	for ( const EndRoom& room : rooms )
	{
		worst = worst == nullptr || rank( room ) < rank( *worst ) ? &room : worst;
	}
	if ( worst == nullptr )
	{
		return "";
	}
	const std::string label = std::string( side_names[side] ) +
	                          ( rooms.size() > 1 ? " (the worst of " + std::to_string( rooms.size() ) + ")" : "" ) + ": ";
	if ( !worst->free )
	{
		return label + "not proved free" + stopper( checker, *worst, ": " ) + "\n";
	}
	if ( worst->enclosed )
	{
		return label + "enclosed: no joint moves alone by " + shortNumber( enclosed_travel ) +
		       " rad or m: " + tightJoints( checker, *worst ) + stopper( checker, *worst, "; stopped mostly by " ) + "\n";
	}
	return label + "free travel of single joints, the least first: " + tightJoints( checker, *worst ) +
	       stopper( checker, *worst, "; stopped mostly by " ) + "\n";
}

std::string pairLine( const lw_checker* checker, const Stuck& stuck )
{
	std::string text;
	std::uint64_t all = 0; // may exceed not_free: the numbers of states are estimates
	for ( const BlockingPair& pair : stuck.pairs )
	{
		all += pair.count();
	}
	for ( std::size_t i = 0; i < std::min( shown_pairs, stuck.pairs.size() ); ++i )
	{
		const double share =
		    static_cast<double>( stuck.pairs[i].count() ) / static_cast<double>( std::max( all, stuck.not_free ) );
		text += ( i > 0 ? ", " : "in the way: " ) + pairName( checker, stuck.pairs[i] ) + " " + percent( share );
	}
	const std::string motions =
	    stuck.not_free == 1 ? "one motion that was" : std::to_string( stuck.not_free ) + " motions that were";
	return text.empty() ? "" : text + " of " + motions + " not free\n";
}

std::string remedyLine( const lw_checker* checker, const Stuck& stuck, const Remedies& remedies )
{
	std::vector<std::string> all;
	for ( unsigned side = 0; side < 2; ++side )
	{
		for ( const EndRoom& room : stuck.ends[side] )
		{
			if ( !room.free || room.enclosed )
			{
				all.push_back( std::string( "another " ) + side_names[side] );
				break;
			}
		}
	}
	const bool main_pair =
	    stuck.not_free >= least_evidence && !stuck.pairs.empty() && stuck.pairs[0].a != LW_INVALID_INDEX &&
	    static_cast<double>( stuck.pairs[0].count() ) >= main_share * static_cast<double>( stuck.not_free );
	if ( main_pair )
	{
		all.push_back( "to allow the contact of " + pairName( checker, stuck.pairs[0] ) + " if it is meant" );
	}
	if ( stuck.min_d > 0 )
	{
		all.push_back( std::string( "a smaller " ) + remedies.min_d );
	}
	const auto any_free = []( const std::vector<EndRoom>& rooms )
	{ return std::any_of( rooms.begin(), rooms.end(), []( const EndRoom& room ) { return room.free; } ); };
	if ( any_free( stuck.ends[0] ) && any_free( stuck.ends[1] ) )
	{
		all.push_back( std::string( "more " ) + remedies.time );
		all.push_back( std::string( "another " ) + remedies.seed );
	}
	std::string text;
	for ( std::size_t i = 0; i < all.size(); ++i )
	{
		text += ( i == 0 ? "try " : i + 1 < all.size() ? ", " : " or " ) + all[i];
	}
	return text.empty() ? "" : text + "\n";
}

} // namespace

std::string pairName( const lw_checker* checker, const BlockingPair& pair )
{
	if ( pair.a == LW_INVALID_INDEX )
	{
		return "motions too long to check";
	}
	const lw_robot* robot = lw_checker_robot( checker );
	const lw_scene* scene = lw_checker_scene( checker );
	const char* first = lw_robot_link_name( robot, pair.a );
	const char* second = pair.self ? lw_robot_link_name( robot, pair.b )
	                               : ( scene != nullptr ? lw_scene_object_name( scene, pair.b ) : nullptr );
	return std::string( first != nullptr ? first : "?" ) + " - " + ( second != nullptr ? second : "?" );
}

std::string describe( const lw_checker* checker, const Stuck& stuck, const Remedies& remedies )
{
	return treeLine( stuck ) + endLine( checker, stuck.ends[0], 0 ) + endLine( checker, stuck.ends[1], 1 ) +
	       pairLine( checker, stuck ) + remedyLine( checker, stuck, remedies );
}

} // namespace leeway::planners
