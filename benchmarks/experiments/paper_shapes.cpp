// SPDX-License-Identifier: BSD-3-Clause
// Figure 9a: extra time of GREEDY spheres over COMPACT and MINIMAL ones for two cubes. Figure 4: sizes of the spheres.
// Paper: Steinbach, Kuffner, Asfour, Dillmann 2006, sections II.B and VI.
#include "experiments/paper.hpp"
#include "report/rounds.hpp"
#include "shape/shape.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace
{

namespace io = leeway::io;

struct Mesh
{
	std::vector<double> vertices;
	std::vector<std::uint32_t> triangles;
};

constexpr lw_sphere_fit FITS[] = { LW_FIT_GREEDY, LW_FIT_COMPACT, LW_FIT_MINIMAL };
const char* const FIT_NAMES[] = { "GREEDY", "COMPACT", "MINIMAL" };
enum
{
	GREEDY,
	COMPACT,
	MINIMAL,
	FIT_COUNT
};

constexpr double EDGE = 0.1; ///< of the cubes, metres
constexpr double ALPHAS[] = { 0, 0.3 };

leeway::Shape shapeOf( const Mesh& mesh, const lw_tree_def& tree )
{
	lw_mesh_def def = lw_mesh_def_default();
	def.vertices = mesh.vertices.data();
	def.vertex_count = static_cast<std::uint32_t>( mesh.vertices.size() / 3 );
	def.indices = mesh.triangles.data();
	def.triangle_count = static_cast<std::uint32_t>( mesh.triangles.size() / 3 );
	def.tree = tree;
	lw_shape* shape = nullptr;
	lw_diag diag{};
	leeway::require( lw_shape_create_mesh( &def, nullptr, &diag, &shape ), diag );
	return leeway::Shape::adopt( shape );
}

/// A rectangle from a corner along two sides, in cells x cells squares of two triangles. Vertices are welded by the core.
void addRectangle( Mesh& mesh, const std::array<double, 3>& corner, const std::array<double, 3>& u,
    const std::array<double, 3>& v, std::uint32_t cells )
{
	const auto first = static_cast<std::uint32_t>( mesh.vertices.size() / 3 );
	for ( std::uint32_t i = 0; i <= cells; ++i )
	{
		for ( std::uint32_t k = 0; k <= cells; ++k )
		{
			for ( std::size_t axis = 0; axis < 3; ++axis )
			{
				mesh.vertices.push_back( corner[axis] + u[axis] * i / cells + v[axis] * k / cells );
			}
		}
	}
	for ( std::uint32_t i = 0; i < cells; ++i )
	{
		for ( std::uint32_t k = 0; k < cells; ++k )
		{
			const std::uint32_t a = first + i * ( cells + 1 ) + k, b = a + cells + 1;
			mesh.triangles.insert( mesh.triangles.end(), { a, b, a + 1, a + 1, b, b + 1 } );
		}
	}
}

/// The six faces of a box.
void addBox( Mesh& mesh, const std::array<double, 3>& low, const std::array<double, 3>& size, std::uint32_t cells )
{
	for ( std::size_t axis = 0; axis < 3; ++axis )
	{
		std::array<double, 3> u{}, v{}, far = low;
		u[( axis + 1 ) % 3] = size[( axis + 1 ) % 3];
		v[( axis + 2 ) % 3] = size[( axis + 2 ) % 3];
		far[axis] += size[axis];
		addRectangle( mesh, low, u, v, cells );
		addRectangle( mesh, far, u, v, cells );
	}
}

Mesh cube( std::uint32_t cells )
{
	Mesh mesh;
	addBox( mesh, { -EDGE / 2, -EDGE / 2, -EDGE / 2 }, { EDGE, EDGE, EDGE }, cells );
	return mesh;
}

/// Two bars at a right angle, as in the paper's figure 4.
Mesh lShape( std::uint32_t cells )
{
	Mesh mesh;
	addBox( mesh, { 0, 0, 0 }, { 0.3, 0.1, 0.1 }, cells );
	addBox( mesh, { 0, 0, 0.1 }, { 0.1, 0.1, 0.2 }, cells );
	return mesh;
}

double uniform( std::mt19937_64& random )
{
	return static_cast<double>( random() >> 11 ) * 0x1p-53;
}

lw_transform randomTurn( std::mt19937_64& random )
{
	double q[4], square = 2;
	while ( square > 1 || square < 1e-3 ) // uniform in the ball, so uniform in direction
	{
		square = 0;
		for ( double& x : q )
		{
			x = 2 * uniform( random ) - 1;
			square += x * x;
		}
	}
	for ( double& x : q )
	{
		x /= std::sqrt( square );
	}
	const double zero[3] = { 0, 0, 0 };
	lw_transform turn;
	leeway::require( lw_transform_from_quaternion( zero, q, &turn ), "a turn" );
	return turn;
}

leeway::Query shapeQuery( bool planes )
{
	lw_query_def def = lw_query_def_default();
	def.planes = planes;
	lw_query* query = nullptr;
	leeway::require( lw_query_create( &def, nullptr, nullptr, nullptr, &query ), "a query" );
	return leeway::Query( query );
}

// --- figure 9a -------------------------------------------------------------------------------------------------------

/// How trees are made and searched.
struct Style
{
	const char *id, *name;
	std::uint32_t cells; ///< of a cube's face, along an edge
	std::uint32_t leaf_size;
	double tile_radius;
	bool planes;
};

const Style STYLES[] = {
    { "tiles", "as in the paper: leaf spheres that tile 12 triangles (5 mm), one to a leaf, spheres only", 1, 1, 0.005,
        false },
    { "leeway", "as leeway does it: 12,288 triangles, eight to a leaf, planes and slabs too", 32, 8, 0, true },
};

struct Poses
{
	lw_transform a, b;
};

lw_clearance distance( const leeway::Shape& shape, const Poses& poses, const lw_range& range, lw_query* query )
{
	lw_clearance c;
	leeway::require( lw_shape_distance( shape.get(), &poses.a, shape.get(), &poses.b, &range, query, &c ), "two cubes" );
	return c;
}

/// How the cubes lie to each other.
struct Lie
{
	const char *id, *name;
	bool facing;
};

const Lie LIES[] = { { "turned", "turned at random", false }, { "facing", "face to face, shifted sideways", true } };

/// Turned at random, then moved along the line between their nearest points until it is `gap` long: by the triangle
/// inequality no other points come nearer than that. Or side by side.
Poses posesAt( const leeway::Shape& shape, const Lie& lie, double gap, std::mt19937_64& random )
{
	if ( lie.facing )
	{
		Poses poses = { lw_transform_identity(), lw_transform_identity() };
		poses.b.t[0] = EDGE + gap;
		poses.b.t[1] = 0.4 * EDGE * ( uniform( random ) - 0.5 );
		poses.b.t[2] = 0.4 * EDGE * ( uniform( random ) - 0.5 );
		return poses;
	}
	Poses poses = { randomTurn( random ), randomTurn( random ) };
	const leeway::Query query = shapeQuery( true );
	poses.b.t[0] = 4 * EDGE;
	const lw_clearance c = distance( shape, poses, lw_range_exact(), query.get() );
	const double share = ( c.upper - gap ) / c.upper;
	poses.b.t[0] += share * ( c.point_a.x - c.point_b.x );
	poses.b.t[1] += share * ( c.point_a.y - c.point_b.y );
	poses.b.t[2] += share * ( c.point_a.z - c.point_b.z );
	return poses;
}

/// Measurements at one separation with one alpha.
struct Sample
{
	double gap = 0;
	Measure time[FIT_COUNT], over_compact, over_minimal;  ///< microseconds; percent
	double nodes[FIT_COUNT] = {}, leaves[FIT_COUNT] = {}; ///< tests of eight spheres, and of two leaves, per query
};

/// The sweep over separation of one kind of trees and poses.
struct Sweep
{
	const Style* style;
	const Lie* lie;
	std::vector<Sample> samples[2]; ///< by ALPHAS
	std::string name() const { return std::string( style->id ) + ", " + lie->id; }
	/// Extra percent of GREEDY over COMPACT, mean over the samples from one gap to another.
	double extra( int alpha, double from, double to ) const
	{
		double sum = 0, count = 0;
		for ( const Sample& s : samples[alpha] )
		{
			if ( s.gap >= from && s.gap <= to )
			{
				sum += s.over_compact.median;
				count += 1;
			}
		}
		return sum / count;
	}
};

std::vector<double> separations( const ExperimentSettings& settings )
{
	if ( settings.quick || settings.smoke )
	{
		return { 0.0001, 0.001, 0.003, 0.01, 0.03, 0.1, 0.3 };
	}
	return { 0.00003, 0.0001, 0.0003, 0.001, 0.002, 0.003, 0.006, 0.01, 0.02, 0.03, 0.06, 0.1, 0.2, 0.4 };
}

Sample measureGap( const leeway::Shape ( &shapes )[FIT_COUNT], const Style& style, double alpha, double gap,
    const std::vector<Poses>& poses, int passes, Progress& progress )
{
	std::vector<Contender> contenders;
	std::vector<leeway::Query> queries;
	const lw_range range = { 0, std::numeric_limits<double>::infinity(), alpha };
	for ( std::size_t fit = 0; fit < FIT_COUNT; ++fit )
	{
		queries.push_back( shapeQuery( style.planes ) );
		lw_query* query = queries.back().get();
		const leeway::Shape& shape = shapes[fit];
		contenders.push_back( { FIT_NAMES[fit], [&shape, &poses, range, query]( const double* q )
		    {
			    const lw_clearance c = distance( shape, poses[questionNumber( q )], range, query );
			    return Answer{ c.lower, c.upper };
		    } } );
	}
	const std::vector<Rounds> rounds = raceRounds( contenders, poses.size(), passes, progress, "figure 9a" );
	Sample sample;
	sample.gap = gap;
	for ( std::size_t fit = 0; fit < FIT_COUNT; ++fit )
	{
		sample.time[fit] = timeOf( rounds[fit] );
		const lw_query_stats stats = lw_query_get_stats( queries[fit].get() );
		sample.nodes[fit] = static_cast<double>( stats.node_tests ) / static_cast<double>( stats.queries );
		sample.leaves[fit] = static_cast<double>( stats.leaf_tests ) / static_cast<double>( stats.queries );
	}
	sample.over_compact = ratioOf( rounds[GREEDY], rounds[COMPACT], 1, 100 );
	sample.over_minimal = ratioOf( rounds[GREEDY], rounds[MINIMAL], 1, 100 );
	return sample;
}

/// All separations of one kind of trees and poses.
Sweep measureSweep( const Style& style, const Lie& lie, const ExperimentSettings& settings, Progress& progress )
{
	leeway::Shape shapes[FIT_COUNT];
	for ( std::size_t fit = 0; fit < FIT_COUNT; ++fit )
	{
		shapes[fit] = shapeOf( cube( style.cells ), { FITS[fit], style.leaf_size, style.tile_radius } );
	}
	const std::vector<double> gaps = separations( settings );
	// face to face takes milliseconds where there are no slabs
	const std::size_t count = lie.facing ? settings.pick( 6, 2, 1 ) : settings.pick( 40, 16, 2 );
	const int passes = static_cast<int>( lie.facing ? settings.pick( 9, 3, 1 ) : settings.pick( 15, 7, 1 ) );
	Sweep sweep{ &style, &lie, {} };
	double step = 0;
	for ( int alpha = 0; alpha < 2; ++alpha )
	{
		std::mt19937_64 random( settings.seed );
		for ( const double gap : gaps )
		{
			std::vector<Poses> poses;
			for ( std::size_t i = 0; i < count; ++i )
			{
				poses.push_back( posesAt( shapes[MINIMAL], lie, gap, random ) );
			}
			const double steps = 2.0 * static_cast<double>( gaps.size() );
			PartProgress part( progress, step / steps, ( step + 1 ) / steps );
			sweep.samples[alpha].push_back( measureGap( shapes, style, ALPHAS[alpha], gap, poses, passes, part ) );
			step += 1;
		}
	}
	return sweep;
}

void addRows( Table& table, const Sweep& sweep )
{
	for ( int alpha = 0; alpha < 2; ++alpha )
	{
		for ( const Sample& s : sweep.samples[alpha] )
		{
			table.rows.push_back( { sweep.style->id, sweep.lie->id, ALPHAS[alpha], 1e3 * s.gap, s.time[GREEDY],
			    s.time[COMPACT], s.time[MINIMAL], s.over_compact, s.over_minimal, s.nodes[GREEDY], s.nodes[COMPACT],
			    s.nodes[MINIMAL], s.leaves[GREEDY], s.leaves[COMPACT], s.leaves[MINIMAL] } );
		}
	}
}

Plot plotOf( const Sweep& sweep )
{
	Plot plot{ std::string( "9a-" ) + sweep.style->id + "-" + sweep.lie->id,
	    "Extra time of GREEDY spheres, two cubes: " + sweep.name(),
	    std::string( "Cubes of 0.1 m, " ) + sweep.lie->name + "; trees " + sweep.style->name +
	        ". Bands are quartiles over the passes; how many tests each needs is in the table.",
	    { "separation", "mm", true }, { "more than the other", "%" }, {}, {}, {} };
	for ( int alpha = 0; alpha < 2; ++alpha )
	{
		Series compact{ say( "over COMPACT, alpha %g", ALPHAS[alpha] ), {}, Mark::LINES, false };
		Series minimal{ say( "over MINIMAL, alpha %g", ALPHAS[alpha] ), {}, Mark::LINES, false };
		for ( const Sample& s : sweep.samples[alpha] )
		{
			const double x = 1e3 * s.gap;
			compact.points.push_back( { x, s.over_compact.median, s.over_compact.lower, s.over_compact.upper } );
			minimal.points.push_back( { x, s.over_minimal.median, s.over_minimal.lower, s.over_minimal.upper } );
		}
		plot.series.insert( plot.series.end(), { compact, minimal } );
	}
	return plot;
}

/// A claim that is tested in each sweep: it holds if it holds in all sweeps, and partly if in some.
Claim claimOf( const std::vector<Sweep>& sweeps, const std::string& text, const std::function<bool( const Sweep& )>& holds,
    const std::function<std::string( const Sweep& )>& figure, const std::function<std::string( const Sweep& )>& why )
{
	Claim claim{ "figure 9a", text, "", Verdict::HOLDS, "" };
	std::size_t held = 0;
	for ( const Sweep& sweep : sweeps )
	{
		const bool mine = holds( sweep );
		held += mine;
		claim.figure += ( claim.figure.empty() ? "" : "; " ) + sweep.name() + ": " + figure( sweep );
		if ( !mine )
		{
			claim.why += ( claim.why.empty() ? "" : " " ) + sweep.name() + ": " + why( sweep ) + ".";
		}
	}
	claim.verdict = held == sweeps.size() ? Verdict::HOLDS : held > 0 ? Verdict::PARTLY : Verdict::DIFFERS;
	return claim;
}

/// The work of a sample: the fits differ in tests of nodes; leaves are the same triangles for all.
std::string workOf( const Sample& s )
{
	return say( "at %g mm ", 1e3 * s.gap ) + say( "COMPACT tests %.0f nodes", s.nodes[COMPACT] ) +
	       say( " and %.0f pairs of leaves, ", s.leaves[COMPACT] ) + say( "GREEDY %.0f", s.nodes[GREEDY] ) +
	       say( " and %.0f", s.leaves[GREEDY] );
}

void addCubeClaims( Outcome& out, const std::vector<Sweep>& sweeps )
{
	// from one edge length on the cubes are far from each other, below a hundredth near
	constexpr double FAR = 0.999 * EDGE, NEAR = EDGE / 99, EVER = 1e9;
	constexpr double LITTLE = 5, TIE = 15; // percent
	const auto both = []( const Sweep& s, double from, double to ) {
		return say( "%+.0f %% (alpha 0)", s.extra( 0, from, to ) ) + say( ", %+.0f %% (alpha 0.3)", s.extra( 1, from, to ) );
	};
	out.claims.push_back( claimOf(
	    sweeps, "at a distance GREEDY spheres take longer than COMPACT ones",
	    [&]( const Sweep& s ) { return s.extra( 0, FAR, EVER ) > LITTLE && s.extra( 1, FAR, EVER ) > LITTLE; },
	    [&]( const Sweep& s ) { return both( s, FAR, EVER ) + " from one edge length on"; },
	    []( const Sweep& s )
	    { return workOf( s.samples[0].back() ) + "; with alpha 0.3, " + workOf( s.samples[1].back() ); } ) );
	out.claims.push_back( claimOf(
	    sweeps, "near contact more nodes have to be traversed, and both take about the same time",
	    [&]( const Sweep& s ) { return std::max( s.extra( 0, 0, NEAR ), s.extra( 1, 0, NEAR ) ) < TIE; },
	    [&]( const Sweep& s ) { return both( s, 0, NEAR ) + " up to a hundredth of the edge"; },
	    []( const Sweep& s )
	    {
		    const Sample &near = s.samples[0].front(), &far = s.samples[0].back();
		    const double nearer = near.nodes[COMPACT] + near.leaves[COMPACT],
		                 farther = far.nodes[COMPACT] + far.leaves[COMPACT];
		    return workOf( near ) + say( "; near contact is %.2f times the work", nearer / farther ) +
		           say( " of %g mm", 1e3 * far.gap ) +
		           ( nearer < farther
		                   ? ": it is not the many nodes near contact here, in which the paper's fits became alike"
		                   : "" );
	    } ) );
	out.claims.push_back( claimOf(
	    sweeps, "the larger error tolerance favours COMPACT",
	    []( const Sweep& s ) { return s.extra( 1, 0, EVER ) > s.extra( 0, 0, EVER ); },
	    [&]( const Sweep& s ) { return both( s, 0, EVER ) + " over all separations"; },
	    []( const Sweep& s )
	    {
		    return "at the farthest separation alpha 0.3 leaves " +
		           say( "%.0f tests, in which no fit has much to gain",
		               s.samples[1].back().nodes[COMPACT] + s.samples[1].back().leaves[COMPACT] ) +
		           say( ", against %.0f exactly", s.samples[0].back().nodes[COMPACT] + s.samples[0].back().leaves[COMPACT] );
	    } ) );
}

void addCubes( const ExperimentSettings& settings, Progress& progress, Outcome& out )
{
	Table table{ "cubes", "Two cubes of 0.1 m (figure 9a)",
	    "Mean time per query over the poses, medians and quartiles over the passes. Tests are of eight spheres at a step, "
	    "or of "
	    "two leaves. Trees: tiles = " +
	        std::string( STYLES[0].name ) + "; leeway = " + STYLES[1].name + ".",
	    { { "trees", "" }, { "cubes", "" }, { "alpha", "" }, { "separation", "mm" }, { "GREEDY", "us", -1 },
	        { "COMPACT", "us", -1 }, { "MINIMAL", "us", -1 }, { "GREEDY over COMPACT", "%" }, { "GREEDY over MINIMAL", "%" },
	        { "nodes GREEDY", "" }, { "nodes COMPACT", "" }, { "nodes MINIMAL", "" }, { "leaves GREEDY", "" },
	        { "leaves COMPACT", "" }, { "leaves MINIMAL", "" } },
	    {} };
	std::vector<Sweep> sweeps;
	for ( const Style& style : STYLES )
	{
		for ( const Lie& lie : LIES )
		{
			const double done = 0.25 * static_cast<double>( sweeps.size() );
			PartProgress part( progress, done, done + 0.25 );
			sweeps.push_back( measureSweep( style, lie, settings, part ) );
			addRows( table, sweeps.back() );
			out.plots.push_back( plotOf( sweeps.back() ) );
		}
	}
	addCubeClaims( out, sweeps );
	out.tables.push_back( table );
}

// --- figure 4 --------------------------------------------------------------------------------------------------------

/// Sums of sphere volumes by level, for each fit, over some meshes.
struct Levels
{
	std::string name;
	std::vector<std::array<double, FIT_COUNT>> volume;
	std::vector<std::uint32_t> spheres;
	double box = 0; ///< of the meshes' boxes
};

/// The same vertices and triangles with another tree.
leeway::Shape rebuilt( const lw_shape* shape, const lw_tree_def& tree )
{
	const lw_shape_info info = lw_shape_get_info( shape );
	Mesh mesh;
	mesh.vertices.assign( lw_shape_vertices( shape ), lw_shape_vertices( shape ) + 3 * std::size_t{ info.vertex_count } );
	mesh.triangles.assign(
	    lw_shape_triangles( shape ), lw_shape_triangles( shape ) + 3 * std::size_t{ info.triangle_count } );
	return shapeOf( mesh, tree );
}

/// Sums over the spheres of one level of a tree. Each level contains all of the geometry: where a branch ends above it, the
/// branch's last sphere counts.
struct TreeLevel
{
	double volume = 0; // cubic metres
	std::uint32_t spheres = 0;
};
using TreeLevels = std::array<TreeLevel, LWI_MAX_DEPTH + 2>;

/// Adds the spheres of a subtree to their levels. Recursion is as deep as the tree: at most LWI_MAX_DEPTH.
void addSubtree(
    const lw_shape& shape, lwi_ref ref, double radius, std::uint32_t level, std::uint32_t count, TreeLevels& levels )
{
	const double volume = 4.0 / 3.0 * std::acos( -1.0 ) * radius * radius * radius;
	const std::uint32_t last = lwi_ref_is_leaf( ref ) ? count - 1 : level;
	for ( std::uint32_t i = level; i <= last; ++i )
	{
		levels[i].volume += volume;
		levels[i].spheres++;
	}
	for ( std::uint32_t lane = 0; !lwi_ref_is_leaf( ref ) && lane < LWI_WIDTH; ++lane )
	{
		const lwi_node& node = shape.nodes[lwi_ref_index( ref )];
		if ( node.child[lane] != LW_INVALID_INDEX )
		{
			addSubtree( shape, node.child[lane], static_cast<double>( node.r[lane] ), level + 1, count, levels );
		}
	}
}

/// @param shape a mesh. @return number of levels; 0 if it has no tree
std::uint32_t treeLevels( const lw_shape* shape, TreeLevels& levels )
{
	levels = {};
	if ( lw_shape_complete( shape, nullptr ) != LW_OK )
	{
		return 0;
	}
	const lw_shape* made = lwi_shape_now( shape );
	if ( made->family != LWI_TRIANGLES )
	{
		return 0;
	}
	const std::uint32_t count = made->depth + 1; // the root's own sphere, and one level below each inner one
	addSubtree( *made, made->root, static_cast<double>( made->root_sphere[3] ), 0, count, levels );
	return count;
}

Levels levelsOf( const std::string& name, const std::vector<const lw_shape*>& shapes )
{
	Levels levels;
	levels.name = name;
	TreeLevels mine;
	levels.volume.resize( mine.size() );
	levels.spheres.resize( mine.size() );
	std::uint32_t deepest = 0;
	for ( const lw_shape* shape : shapes )
	{
		const lw_shape_info info = lw_shape_get_info( shape );
		levels.box += ( info.box_max[0] - info.box_min[0] ) * ( info.box_max[1] - info.box_min[1] ) *
		              ( info.box_max[2] - info.box_min[2] );
		for ( int fit = 0; fit < FIT_COUNT; ++fit )
		{
			const lw_tree_def tree = { FITS[fit], 8, 0 };
			const std::uint32_t count = treeLevels( rebuilt( shape, tree ).get(), mine );
			deepest = std::max( deepest, count );
			for ( std::uint32_t i = 0; i < mine.size() && count > 0; ++i )
			{
				// below its last level a tree stays as it is there
				levels.volume[i][static_cast<std::size_t>( fit )] += mine[std::min( i, count - 1 )].volume;
				levels.spheres[i] += fit == 0 ? mine[std::min( i, count - 1 )].spheres : 0;
			}
		}
	}
	levels.volume.resize( deepest );
	return levels;
}

std::vector<Levels> measureLevels( const ExperimentSettings& settings )
{
	const lw_tree_def tree = lw_tree_def_default();
	const leeway::Shape l = shapeOf( lShape( 12 ), tree ), box = shapeOf( cube( 32 ), tree );
	std::vector<Levels> all = { levelsOf( "L-shape", { l.get() } ), levelsOf( "cube", { box.get() } ) };
	if ( !settings.data.empty() )
	{
		const io::Problem kitchen = loadKitchen( settings.data, tree );
		std::vector<const lw_shape*> links, objects;
		const auto add = []( std::vector<const lw_shape*>& list, const lw_shape* shape )
		{
			if ( std::find( list.begin(), list.end(), shape ) == list.end() ) // each mesh once
			{
				list.push_back( shape );
			}
		};
		for ( std::uint32_t i = 0; i < lw_robot_body_count( kitchen.robot.get() ); ++i )
		{
			add( links, lw_robot_body( kitchen.robot.get(), i ).shape );
		}
		for ( std::uint32_t i = 0; i < lw_scene_shape_count( kitchen.scene.get() ); ++i )
		{
			add( objects, lw_scene_shape( kitchen.scene.get(), i ).shape );
		}
		all.push_back( levelsOf( "robot links", links ) );
		all.push_back( levelsOf( "kitchen objects", objects ) );
	}
	return all;
}

void addLevels( const ExperimentSettings& settings, Outcome& out )
{
	Table table{ "levels", "Volume of the spheres of each level (figure 4)",
	    "Sums over all spheres of a level, in multiples of the volume of the meshes' boxes. Level 0 is the root; where a "
	    "branch ends its last sphere stands for it on the levels below. Trees of eight children and eight triangles to a "
	    "leaf, "
	    "with the same triangles under each node whatever the fit.",
	    { { "geometry", "" }, { "level", "" }, { "spheres", "" }, { "GREEDY", "boxes", -1 }, { "COMPACT", "boxes", -1 },
	        { "MINIMAL", "boxes", -1 }, { "GREEDY / COMPACT", "" }, { "COMPACT / MINIMAL", "" } },
	    {} };
	Plot volume{ "4-l-shape", "Sphere volume by level, L-shape", "Two bars of 0.1 m, 3,456 triangles.", { "level", "" },
	    { "volume of all spheres", "boxes", true }, {}, {}, {} };
	Plot ratio{ "4-ratio", "Volume of GREEDY spheres over COMPACT ones, by level", "", { "level", "" },
	    { "GREEDY / COMPACT", "" }, {}, {}, {} };
	ratio.y.from = 1;
	volume.x.from = ratio.x.from = 0;
	volume.x.step = ratio.x.step = 1;
	bool every = true;
	std::string figures;
	for ( const Levels& levels : measureLevels( settings ) )
	{
		Series line{ levels.name, {}, Mark::LINES, false };
		double least = std::numeric_limits<double>::infinity(), most = 0;
		for ( std::size_t i = 0; i < levels.volume.size(); ++i )
		{
			const auto& v = levels.volume[i];
			const double over = v[GREEDY] / v[COMPACT];
			table.rows.push_back( { levels.name, static_cast<double>( i ), static_cast<double>( levels.spheres[i] ),
			    v[GREEDY] / levels.box, v[COMPACT] / levels.box, v[MINIMAL] / levels.box, over, v[COMPACT] / v[MINIMAL] } );
			line.points.push_back( { static_cast<double>( i ), over } );
			least = std::min( least, over );
			most = std::max( most, over );
		}
		ratio.series.push_back( line );
		every = every && least > 1;
		figures += ( figures.empty() ? "" : ", " ) + levels.name + say( " %.2f", least ) + say( " to %.2f times", most );
		for ( std::size_t fit = 0; levels.name == "L-shape" && fit < FIT_COUNT; ++fit )
		{
			volume.series.push_back( { FIT_NAMES[fit], {}, fit == MINIMAL ? Mark::DASHES : Mark::LINES, false } );
			for ( std::size_t i = 0; i < levels.volume.size(); ++i )
			{
				volume.series[fit].points.push_back( { static_cast<double>( i ), levels.volume[i][fit] / levels.box } );
			}
		}
	}
	out.tables.push_back( table );
	out.plots.push_back( volume );
	out.plots.push_back( ratio );
	out.claims.push_back(
	    { "figure 4", "each level of the COMPACT hierarchy contains the geometry more compactly than GREEDY",
	        "volume of GREEDY over COMPACT: " + figures, every ? Verdict::HOLDS : Verdict::PARTLY,
	        every ? ""
	              : "On some level the volume is not larger: see the table; where only single leaves differ both are the "
	                "spheres of a few triangles." } );
}

} // namespace

void addPaperShapes( const ExperimentSettings& settings, Progress& progress, Outcome& out )
{
	PartProgress cubes( progress, 0, 0.9 );
	addCubes( settings, cubes, out );
	progress.at( 0.9, "figure 4" );
	addLevels( settings, out );
	progress.at( 1, "figure 4" );
}
