// SPDX-License-Identifier: BSD-3-Clause
// The search: see planner.hpp.
#include "explain.hpp"
#include "samples.hpp"
#include "space.hpp"
#include "tree.hpp"
#include "validator.hpp"

#include <algorithm>
#include <array>
#include <iterator>

namespace leeway::planners
{

void requireUsable( const Settings& settings )
{
	const auto need = []( bool condition, const char* sentence )
	{
		if ( !condition ) // written as "condition holds" so that a NaN is refused
		{
			throw InputError( std::string( "leeway::planners: Settings: " ) + sentence );
		}
	};
	const lw_edge_def& edge = settings.edge;
	need( edge.cookie == lw_edge_def_default().cookie, "make edge with lw_edge_def_default()" );
	need( edge.min_d >= 0 && std::isfinite( edge.min_d ), "edge.min_d must be finite and at least 0" );
	need( edge.slack > 0 && std::isfinite( edge.slack ), "edge.slack must be finite and above 0" );
	need( settings.range >= 0 && std::isfinite( settings.range ), "range must be finite and at least 0" );
	need( settings.sample_radius >= 0 && std::isfinite( settings.sample_radius ),
	    "sample_radius must be finite and at least 0" );
	need( settings.most_nodes >= 2 && settings.most_nodes <= no_node, "most_nodes must be 2 to 2^32 - 1" );
}

namespace
{

constexpr unsigned quarters = 4; // states checked per step towards the other tree
constexpr unsigned steps_ahead = lanes / quarters;
constexpr std::uint64_t early_samples = 64;         // half of these lie anywhere: they solve easy problems
constexpr unsigned waiting_edges = 4;               // not proved yet, in a row, before a node from which a tree grows
constexpr std::uint64_t least_free_per_failure = 4; // late proofs: with fewer, edges are proved at once

/// Rough quantile of a bell curve with variance near 1 (Tukey's lambda, 0.14): directions of samples need no more.
double tukeyQuantile( double u )
{
	u = std::clamp( u, 1e-9, 1 - 1e-9 );
	return ( std::pow( u, 0.14 ) - std::pow( 1 - u, 0.14 ) ) / 0.1975;
}

constexpr std::size_t quantile_parts = 512,
                      quantile_tail = 16; // of a table of quantiles; parts at each end are computed anew

std::array<double, quantile_parts + 1> quantileTable()
{
	std::array<double, quantile_parts + 1> table{};
	double part = 0;
	for ( double& value : table )
	{
		value = tukeyQuantile( part / quantile_parts );
		++part;
	}
	return table;
}

/// The same by linear interpolation, but for the tails. @param u in [0, 1)
double normalQuantile( double u )
{
	static const std::array<double, quantile_parts + 1> table = quantileTable();
	const double at = u * quantile_parts;
	const auto i = static_cast<std::size_t>( at );
	return i < quantile_tail || i >= quantile_parts - quantile_tail
	           ? tukeyQuantile( u )
	           : table[i] + ( at - static_cast<double>( i ) ) * ( table[i + 1] - table[i] );
}

Checker checkedChecker( Checker checker )
{
	if ( !checker )
	{
		throw InputError( "leeway::planners: Planner: no checker" );
	}
	return checker;
}

/// Samples of a ball that is larger than the bounds would nearly all be cut to them: three quarters of the bounds' diagonal.
double largestRadius( const Space& space )
{
	double square = 0;
	for ( std::size_t i = 0; i < space.size(); ++i )
	{
		const double side = space.upper()[i] - space.lower()[i];
		square += side * side;
	}
	return 0.75 * std::sqrt( square );
}

constexpr std::uint64_t Statistics::*counts[] = { &Statistics::samples, &Statistics::states, &Statistics::states_free,
    &Statistics::lane_states, &Statistics::edges, &Statistics::free, &Statistics::blocked, &Statistics::undecided,
    &Statistics::edge_queries, &Statistics::start_nodes, &Statistics::goal_nodes, &Statistics::passed_over };
static_assert( sizeof( Statistics ) == std::size( counts ) * sizeof( std::uint64_t ), "a count is not in the list" );

} // namespace

Statistics& Statistics::operator+=( const Statistics& more )
{
	for ( const auto count : counts )
	{
		this->*count += more.*count;
	}
	return *this;
}

Statistics Statistics::since( const Statistics& before ) const
{
	Statistics difference;
	for ( const auto count : counts )
	{
		difference.*count = this->*count - before.*count;
	}
	return difference;
}

const char* name( Outcome outcome )
{
	switch ( outcome )
	{
	case Outcome::SOLVED:
		return "solved";
	case Outcome::TIMED_OUT:
		return "timed out";
	case Outcome::CANCELLED:
		return "cancelled";
	case Outcome::NODES_FULL:
		return "most_nodes reached";
	case Outcome::NO_START:
		return "no usable start";
	case Outcome::NO_GOAL:
		return "no usable goal";
	case Outcome::FAILED:
		return "check failed";
	}
	return "?";
}

/// Ends of edges towards samples, looked at together, and used one after the other.
struct Candidates
{
	std::vector<double> ends;        ///< [lanes][variables]
	std::uint32_t nears[lanes] = {}; ///< nodes from which the edges come
	Seen seen[lanes] = {};
	unsigned count = 0, next = 0;
};

struct Planner::Parts
{
	Parts( Checker given, const Settings& s )
	    : checker( checkedChecker( std::move( given ) ) ), settings( s ), space( checker.get(), s.lower, s.upper ),
	      random( s.seed ), halton( space.size() + 1, s.seed ), trees{ Tree( space ), Tree( space ) }, blame( space.size() )
	{
		requireUsable( settings );
		range = settings.range > 0 ? settings.range : geometricRange( checker.get(), space.lower(), space.upper() );
		sample_radius = std::min( settings.sample_radius * range, largestRadius( space ) );
		sample.resize( space.size() );
		next.resize( space.size() );
		ahead.resize( lanes * space.size() );
		for ( Candidates& of_tree : candidates )
		{
			of_tree.ends.resize( lanes * space.size() );
		}
		unit.resize( space.size() + 1 );
	}

	Outcome solve( lw_query* query, const Stop& stop );
	bool addEnds( Validator& validator, Deadline& deadline );
	bool joinStraight( Validator& validator, Deadline& deadline, std::size_t first_start, std::size_t first_goal );
	bool isLineFree( Validator& validator, const double* a, const double* b );
	void drawCandidates( Validator& validator, unsigned side );
	bool grow( Validator& validator );
	bool connect( Validator& validator, unsigned from, std::uint32_t node );
	bool seemsFree( Validator& validator, unsigned step, bool has_new_end );
	void lookAhead( Validator& validator, const double* goal, unsigned step, unsigned steps );
	bool proofsWait() const { return late.not_free * least_free_per_failure <= late.free; }
	std::uint32_t addNode( Validator& validator, Tree& tree, std::uint32_t near, const double* q );
	std::uint32_t provedFor( const Tree& tree, std::uint32_t node ) const;
	bool proveBranch( Validator& validator, unsigned side, std::uint32_t node );
	void findRoots( unsigned side );
	void drawSample( const Tree& tree );
	void drawUnit();
	void finish( unsigned from, std::uint32_t a, std::uint32_t b );
	void appendBranch( const Tree& tree, std::uint32_t node, Path& out ) const;
	std::size_t nodeCount() const { return trees[0].size() + trees[1].size(); }

	Checker checker;
	Settings settings;
	Space space;
	double range, sample_radius; ///< in the metric of the space
	Random random;
	Halton halton;
	Tree trees[2];               ///< from starts, from goals
	std::vector<double> ends[2]; ///< not yet checked
	std::vector<std::uint32_t> roots[2];
	std::vector<double> refused[2]; ///< ends that are not free
	TreeGrowth growth[2];
	double gap = HUGE_VAL; ///< least distance of a node to the other tree
	Blame blame;
	std::vector<double> sample, next, unit;
	Candidates candidates[2];  ///< for the next edges of each tree
	std::vector<double> ahead; ///< [lanes][variables] the way from `from`, by quarters of steps
	Seen seen[lanes] = {};     ///< of these
	std::vector<double> from;
	std::vector<std::uint32_t> branch;
	struct
	{
		std::uint64_t free = 0, not_free = 0;
	} late; ///< proofs that waited
	std::string problem;
	Path path;
	Statistics statistics;
	lw_status failure = LW_OK;
};

/// Numbers in [0, 1), one per variable, and one more for the radius.
void Planner::Parts::drawUnit()
{
	if ( settings.samples == Samples::HALTON )
	{
		halton.next( unit.data() );
		return;
	}
	for ( double& u : unit )
	{
		u = random.uniform();
	}
}

/// A sample of the bounds, or of the ball around a random node of the tree, cut to the bounds. Half of the early ones are of the bounds.
void Planner::Parts::drawSample( const Tree& tree )
{
	++statistics.samples;
	drawUnit();
	const bool anywhere = statistics.samples <= early_samples && random.uniform() < 0.5;
	if ( anywhere || !( settings.sample_radius > 0 ) )
	{
		for ( std::size_t i = 0; i < space.size(); ++i )
		{
			sample[i] = space.lower()[i] + unit[i] * ( space.upper()[i] - space.lower()[i] );
		}
		return;
	}
	double square = 0;
	for ( std::size_t i = 0; i < space.size(); ++i )
	{
		sample[i] = normalQuantile( unit[i] );
		square += sample[i] * sample[i];
	}
	const double* center = tree.state( static_cast<std::uint32_t>( random.below( tree.size() ) ) );
	const double radius =
	    sample_radius * std::pow( unit[space.size()], 1 / static_cast<double>( space.size() ) ) / std::sqrt( square );
	for ( std::size_t i = 0; i < space.size(); ++i )
	{
		sample[i] = center[i] + ( square > 0 ? radius * sample[i] : 0 );
	}
	space.normalise( sample.data() );
}

bool Planner::Parts::isLineFree( Validator& validator, const double* a, const double* b )
{
	const auto free = [&]( const double* p, const double* q )
	{ return validator.seemsFree( space, p, q ) && validator.isEdgeFree( p, q ); };
	if ( space.partCount( a, b ) == 1 )
	{
		return free( a, b );
	}
	space.between( a, b, 0.5, next.data() );
	return free( a, next.data() ) && free( next.data(), b );
}

/// New ends that are free become roots. @return false if the deadline is over
bool Planner::Parts::addEnds( Validator& validator, Deadline& deadline )
{
	for ( unsigned side = 0; side < 2; ++side )
	{
		std::size_t used = 0;
		for ( ; used < ends[side].size() && !deadline.over(); used += space.size() )
		{
			const double* q = ends[side].data() + used;
			if ( validator.isStateFree( q ) )
			{
				roots[side].push_back( trees[side].add( q, no_node ) );
			}
			else
			{
				problem = std::string( side == 0 ? "a start" : "a goal" ) + " is not proved free at the clearance asked for";
				refused[side].insert( refused[side].end(), q, q + space.size() );
			}
		}
		ends[side].erase( ends[side].begin(), ends[side].begin() + static_cast<std::ptrdiff_t>( used ) );
	}
	return !deadline.over();
}

/// Straight edges between roots of which at least one is new.
bool Planner::Parts::joinStraight(
    Validator& validator, Deadline& deadline, std::size_t first_start, std::size_t first_goal )
{
	for ( std::size_t s = 0; s < roots[0].size(); ++s )
	{
		for ( std::size_t g = s < first_start ? first_goal : 0; g < roots[1].size() && !deadline.over(); ++g )
		{
			const double *a = trees[0].state( roots[0][s] ), *b = trees[1].state( roots[1][g] );
			gap = std::min( gap, space.distance( a, b ) );
			if ( isLineFree( validator, a, b ) )
			{
				if ( space.partCount( a, b ) > 1 )
				{
					finish( 0, trees[0].add( next.data(), roots[0][s] ), roots[1][g] );
				}
				else
				{
					finish( 0, roots[0][s], roots[1][g] );
				}
				return true;
			}
		}
	}
	return false;
}

/// The next steps from `from` to a goal, by their quarters, in one look.
void Planner::Parts::lookAhead( Validator& validator, const double* goal, unsigned step, unsigned steps )
{
	const unsigned count = std::min( lanes, ( steps - step ) * quarters );
	for ( unsigned i = 0; i < count; ++i )
	{
		space.between( from.data(), goal, ( step + ( i + 1.0 ) / quarters ) / steps, ahead.data() + i * space.size() );
	}
	validator.look( ahead.data(), count, LW_STATES_ALONG, seen );
}

/// Does one of these steps seem free? Its end is, if that is new.
bool Planner::Parts::seemsFree( Validator& validator, unsigned step, bool has_new_end )
{
	const Seen* mine = seen + step * quarters;
	if ( anyBlocked( mine, quarters ) )
	{
		return false;
	}
	for ( const unsigned i : { 3u, 1u, 0u, 2u } )
	{
		const double* q = ahead.data() + ( step * quarters + i ) * space.size();
		if ( ( i == quarters - 1 ? has_new_end : validator.needsStates() ) && !validator.isFree( q, mine[i] ) )
		{
			return false;
		}
	}
	return true;
}

/// Adds q, which is free as some states before it are, to the tree. The proof of the edge waits until the tree grows from a node
/// `waiting_edges` further on, or a path passes through it: most nodes stay leaves. Where obstacles are so thin that such proofs often
/// fail, it waits no longer.
/// @return no_node if not
std::uint32_t Planner::Parts::addNode( Validator& validator, Tree& tree, std::uint32_t near, const double* q )
{
	const bool waits = proofsWait();
	if ( !waits && !validator.isEdgeFree( tree.state( near ), q ) )
	{
		return no_node;
	}
	const std::uint32_t node = tree.add( q, near );
	if ( !waits )
	{
		// `near` is proved, by grow() or by the step before; a failed proof in between ends the loop of grow()
		tree.setProved( node );
	}
	return node;
}

/// The node whose branch is to be proved before the tree grows from `node`: while proofs wait, an ancestor.
std::uint32_t Planner::Parts::provedFor( const Tree& tree, std::uint32_t node ) const
{
	for ( unsigned k = 0; k < waiting_edges && proofsWait() && tree.parent( node ) != no_node; ++k )
	{
		node = tree.parent( node );
	}
	return node;
}

/// Proves all edges from the root to a node. An edge that is not FREE is removed with all nodes behind it: numbers of nodes change.
bool Planner::Parts::proveBranch( Validator& validator, unsigned side, std::uint32_t node )
{
	Tree& tree = trees[side];
	branch.clear();
	for ( ; !tree.isProved( node ); node = tree.parent( node ) )
	{
		branch.push_back( node );
	}
	for ( ; !branch.empty(); branch.pop_back() )
	{
		const std::uint32_t below = branch.back();
		if ( !validator.isEdgeFree( tree.state( tree.parent( below ) ), tree.state( below ) ) )
		{
			++late.not_free;
			tree.cut( below );
			candidates[side].count = 0; // nodes have new numbers
			findRoots( side );
			return false;
		}
		++late.free;
		tree.setProved( below );
	}
	return true;
}

void Planner::Parts::findRoots( unsigned side )
{
	roots[side].clear();
	for ( std::uint32_t i = 0; i < trees[side].size(); ++i )
	{
		if ( trees[side].parent( i ) == no_node )
		{
			roots[side].push_back( i );
		}
	}
}

/// Draws samples near a tree and checks the ends of its edges towards them in one look.
void Planner::Parts::drawCandidates( Validator& validator, unsigned side )
{
	const Tree& tree = trees[side];
	Candidates& c = candidates[side];
	c.next = 0;
	c.count = validator.looksDecide() ? lanes : 1;
	for ( unsigned i = 0; i < c.count; ++i )
	{
		drawSample( tree );
		c.nears[i] = tree.nearest( sample.data() );
		const double distance = space.distance( tree.state( c.nears[i] ), sample.data() );
		space.between(
		    tree.state( c.nears[i] ), sample.data(), std::min( 1.0, range / distance ), c.ends.data() + i * space.size() );
	}
	growth[side].tries += c.count;
	validator.look( c.ends.data(), c.count, LW_STATES_LANES, c.seen );
}

/// The smaller tree grows by the first of its candidates that can become a node, which then tries to reach the other tree.
/// @return true if the trees met
bool Planner::Parts::grow( Validator& validator )
{
	const unsigned side = trees[0].size() <= trees[1].size() ? 0 : 1;
	Tree& tree = trees[side];
	Candidates& c = candidates[side];
	if ( c.next >= c.count )
	{
		drawCandidates( validator, side );
	}
	while ( c.next < c.count )
	{
		const unsigned i = c.next++;
		const double* q = c.ends.data() + i * space.size();
		if ( c.seen[i].verdict == LW_VERDICT_BLOCKED || !proveBranch( validator, side, provedFor( tree, c.nears[i] ) ) ||
		     !validator.isFree( q, c.seen[i] ) )
		{
			continue;
		}
		const std::uint32_t node =
		    validator.seemsFree( space, tree.state( c.nears[i] ), q ) ? addNode( validator, tree, c.nears[i], q ) : no_node;
		if ( node != no_node )
		{
			++growth[side].grown;
			return connect( validator, side, node );
		}
	}
	return false;
}

/// Steps of equal length from a new node to the nearest node of the other tree, until one fails.
bool Planner::Parts::connect( Validator& validator, unsigned side, std::uint32_t node )
{
	Tree &tree = trees[side], &other = trees[1 - side];
	const std::uint32_t goal = other.nearest( tree.state( node ) );
	const double distance = space.distance( tree.state( node ), other.state( goal ) );
	gap = std::min( gap, distance );
	const auto steps = static_cast<unsigned>( std::max( 1.0, std::ceil( distance / std::min( range, longest_turn ) ) ) );
	from.assign( tree.state( node ), tree.state( node ) + space.size() );
	for ( unsigned step = 0; step < steps; ++step )
	{
		if ( step % steps_ahead == 0 )
		{
			lookAhead( validator, other.state( goal ), step, steps );
		}
		if ( !seemsFree( validator, step % steps_ahead, step + 1 < steps ) )
		{
			return false;
		}
		if ( step + 1 == steps )
		{
			break;
		}
		const double* q = ahead.data() + ( step % steps_ahead + 1 ) * quarters * space.size() - space.size();
		node = addNode( validator, tree, node, q );
		if ( node == no_node )
		{
			return false;
		}
		gap = std::min( gap, distance * ( steps - step - 1 ) / steps );
	}
	if ( !validator.isEdgeFree( tree.state( node ), other.state( goal ) ) || !proveBranch( validator, side, node ) ||
	     !proveBranch( validator, 1 - side, goal ) )
	{
		return false;
	}
	finish( side, node, goal );
	return true;
}

/// States from the node to its root.
void Planner::Parts::appendBranch( const Tree& tree, std::uint32_t node, Path& out ) const
{
	for ( ; node != no_node; node = tree.parent( node ) )
	{
		out.values.insert( out.values.end(), tree.state( node ), tree.state( node ) + space.size() );
	}
}

namespace
{

void reverse( Path& path )
{
	for ( std::size_t i = 0, j = path.count(); i + 1 < j; ++i )
	{
		--j;
		std::swap_ranges( path[i], path[i] + path.dimension, path[j] );
	}
}

} // namespace

void Planner::Parts::finish( unsigned side, std::uint32_t a, std::uint32_t b )
{
	path.dimension = space.size();
	path.values.clear();
	appendBranch( trees[0], side == 0 ? a : b, path );
	reverse( path );
	appendBranch( trees[1], side == 0 ? b : a, path );
}

Outcome Planner::Parts::solve( lw_query* query, const Stop& stop )
{
	if ( path.count() > 0 )
	{
		return Outcome::SOLVED;
	}
	lw_query_reset( query );
	Validator validator( checker.get(), query, settings.edge, statistics, &blame );
	Deadline deadline( stop );
	const std::size_t old_starts = roots[0].size(), old_goals = roots[1].size();
	const auto ended = [&]( Outcome outcome )
	{
		failure = validator.status();
		statistics.start_nodes = trees[0].size();
		statistics.goal_nodes = trees[1].size();
		return failure != LW_OK ? Outcome::FAILED : outcome;
	};
	if ( !addEnds( validator, deadline ) )
	{
		return ended( deadline.outcome() );
	}
	if ( roots[0].empty() || roots[1].empty() )
	{
		const bool start = roots[0].empty();
		problem = problem.empty() ? ( start ? "no start was given" : "no goal was given" ) : problem;
		return ended( start ? Outcome::NO_START : Outcome::NO_GOAL );
	}
	bool met = joinStraight( validator, deadline, old_starts, old_goals );
	while ( !met && !deadline.over() && validator.status() == LW_OK )
	{
		if ( nodeCount() >= settings.most_nodes )
		{
			return ended( Outcome::NODES_FULL );
		}
		met = grow( validator );
	}
	return ended( met ? Outcome::SOLVED : deadline.outcome() );
}

Planner::Planner( Checker checker, const Settings& settings )
    : m_parts( std::make_unique<Parts>( std::move( checker ), settings ) )
{
}
Planner::~Planner() = default;
Planner::Planner( Planner&& ) noexcept = default;
Planner& Planner::operator=( Planner&& ) noexcept = default;

namespace
{

void addEnd( const Space& space, const lw_checker* checker, const double* q, const char* kind, std::vector<double>& ends )
{
	const std::size_t bad = space.firstUnusable( q );
	if ( bad < space.size() )
	{
		throw InputError( std::string( "leeway::planners: " ) + kind + ": joint " + jointName( checker, bad ) + " is at " +
		                  std::to_string( q[bad] ) + ", outside of " + std::to_string( space.lower()[bad] ) + " to " +
		                  std::to_string( space.upper()[bad] ) + "; give a state within the bounds" );
	}
	ends.insert( ends.end(), q, q + space.size() );
	space.wrapAngles( ends.data() + ends.size() - space.size() );
}

} // namespace

void Planner::addStart( const double* q )
{
	addEnd( m_parts->space, m_parts->checker.get(), q, "start", m_parts->ends[0] );
	m_parts->path.values.clear();
}

void Planner::addGoal( const double* q )
{
	addEnd( m_parts->space, m_parts->checker.get(), q, "goal", m_parts->ends[1] );
	m_parts->path.values.clear();
}

Outcome Planner::solve( lw_query* query, const Stop& stop )
{
	return m_parts->solve( query, stop );
}

const Path& Planner::path() const
{
	return m_parts->path;
}

Path Planner::approximatePath( double* distance ) const
{
	const Parts& p = *m_parts;
	Path path;
	path.dimension = p.space.size();
	std::uint32_t best = no_node;
	*distance = HUGE_VAL;
	for ( const std::uint32_t goal : p.roots[1] )
	{
		for ( std::uint32_t i = 0; i < p.trees[0].size(); ++i )
		{
			const double far = p.space.distance( p.trees[0].state( i ), p.trees[1].state( goal ) );
			if ( p.trees[0].isProved( i ) && far < *distance )
			{
				best = i;
				*distance = far;
			}
		}
	}
	p.appendBranch( p.trees[0], best, path );
	reverse( path );
	return path;
}

const std::vector<BlockingPair>& Planner::blockingPairs() const
{
	return m_parts->blame.pairs();
}

Stuck Planner::explain( lw_query* query, const Stop& stop ) const
{
	constexpr std::size_t most_ends = 8;
	const Parts& p = *m_parts;
	Stop brief = stop;
	brief.seconds = std::fmin( stop.seconds, 1 );
	Deadline deadline( brief );
	Stuck stuck;
	stuck.gap = p.gap;
	stuck.not_free = p.blame.count();
	stuck.min_d = p.settings.edge.min_d;
	for ( unsigned side = 0; side < 2; ++side )
	{
		stuck.trees[side] = p.growth[side];
		stuck.trees[side].nodes = p.trees[side].size();
		stuck.trees[side].extent = extent( p.space, p.trees[side] );
		const auto add = [&]( const double* q )
		{
			if ( stuck.ends[side].size() < most_ends )
			{
				stuck.ends[side].push_back( measureRoom( p.checker.get(), query, p.settings.edge, p.space, q, deadline ) );
			}
		};
		for ( const std::uint32_t root : p.roots[side] )
		{
			add( p.trees[side].state( root ) );
		}
		for ( std::size_t i = 0; i < p.refused[side].size(); i += p.space.size() )
		{
			add( p.refused[side].data() + i );
		}
	}
	stuck.pairs = measurePairs( p.checker.get(), query, p.settings.edge, p.blame, deadline );
	return stuck;
}

void Planner::clear()
{
	Parts& p = *m_parts;
	for ( unsigned side = 0; side < 2; ++side )
	{
		p.trees[side].clear();
		p.ends[side].clear();
		p.roots[side].clear();
		p.refused[side].clear();
		p.growth[side] = {};
		p.candidates[side].count = 0;
	}
	p.path.values.clear();
	p.problem.clear();
	p.blame.clear();
	p.gap = HUGE_VAL;
	p.late = {};
	p.statistics = {};
	p.failure = LW_OK;
	p.random = Random( p.settings.seed );
	p.halton = Halton( p.space.size() + 1, p.settings.seed );
}

const Statistics& Planner::statistics() const
{
	return m_parts->statistics;
}

Growth Planner::growth() const
{
	return { m_parts->trees[0].size(), m_parts->trees[1].size(), m_parts->gap };
}

double Planner::range() const
{
	return m_parts->range;
}

std::size_t Planner::dimension() const
{
	return m_parts->space.size();
}

double Planner::distance( const double* a, const double* b ) const
{
	return m_parts->space.distance( a, b );
}

const std::string& Planner::endProblem() const
{
	return m_parts->problem;
}

lw_status Planner::failure() const
{
	return m_parts->failure;
}

void Planner::visitNodes( void ( *visit )( void*, bool, std::uint32_t, const double* ), void* user ) const
{
	for ( unsigned side = 0; side < 2; ++side )
	{
		const Tree& tree = m_parts->trees[side];
		for ( std::uint32_t i = 0; i < tree.size(); ++i )
		{
			visit( user, side == 1, tree.parent( i ), tree.state( i ) );
		}
	}
}

} // namespace leeway::planners
