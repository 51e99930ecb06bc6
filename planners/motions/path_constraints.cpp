// SPDX-License-Identifier: BSD-3-Clause
// Constraints as regions of poses, and joints as ranges of polynomials: control points hold a piece (Farin), halves of it hold it closer.
#include "leeway/motions/path_constraints.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace leeway::motions
{
namespace
{

constexpr int most_halvings = 30;
constexpr double relative_rounding = 0x1p-44; // of the largest control point, by halving

/// Frames of a constraint, in a region without limits.
lw_region_def defOf( const io::Problem& problem, const io::PathConstraints& path, const std::string& link,
    const std::string& frame, const std::string& element )
{
	const io::Frame moved = io::findFrame( problem, link, path.file, element ),
	                base = io::findFrame( problem, frame, path.file, element );
	lw_region_def def = lw_region_def_default();
	def.base_link = base.link;
	def.base_from_a = base.pose;
	def.link = moved.link;
	def.link_from_b = moved.pose;
	return def;
}

lw_region_def defOf( const io::Problem& problem, const io::PathConstraints& path, const io::PositionGoal& goal )
{
	const bool box = goal.regions.size() == 1 && goal.regions.front().type == io::GoalRegion::Type::Box;
	if ( !box )
	{
		throw io::Error( path.file, goal.element, "only one box can be proved along a path",
		    "give one primitive of type box, such as the largest in the region" );
	}
	lw_region_def def = defOf( problem, path, goal.link, goal.frame, goal.element );
	lw_transform offset = lw_transform_identity();
	std::copy( goal.offset.begin(), goal.offset.end(), offset.t );
	def.link_from_b = lw_transform_multiply( &def.link_from_b, &offset );
	def.start = goal.regions.front().pose;
	for ( std::size_t i = 0; i < 3; ++i )
	{
		def.upper[i] = 0.5 * goal.regions.front().size[i];
		def.lower[i] = -def.upper[i];
	}
	return def;
}

lw_region_def defOf( const io::Problem& problem, const io::PathConstraints& path, const io::OrientationGoal& goal )
{
	lw_region_def def = defOf( problem, path, goal.link, goal.frame, goal.element );
	const double none[3] = { 0, 0, 0 };
	require( lw_transform_from_quaternion( none, goal.quaternion.data(), &def.start ), "orientation constraint" );
	std::copy( goal.tolerance.begin(), goal.tolerance.end(), def.turns );
	def.turns_are =
	    goal.parameterization == io::OrientationGoal::Parameterization::euler_xyz ? LW_TURNS_XYZ : LW_TURNS_VECTOR;
	return def;
}

RegionHandle regionOf(
    const io::Problem& problem, const io::PathConstraints& path, const std::string& element, const lw_region_def& def )
{
	lw_diag diag = {};
	lw_region* made = nullptr;
	if ( lw_region_create( problem.checker.get(), &def, nullptr, &diag, &made ) != LW_OK )
	{
		throw io::Error( path.file, element, diag.message, "give a constraint with room" );
	}
	return RegionHandle( made );
}

ConstraintProof proveRegion( const io::Problem& problem, const PoseConstraint& constraint,
    const std::vector<Segment>& segments, const std::vector<double>& tolerance )
{
	ConstraintProof proof;
	proof.element = constraint.element;
	if ( !constraint.region ) // any orientation will do
	{
		return proof;
	}
	const auto count = static_cast<std::uint32_t>( problem.variables.size() );
	std::vector<std::uint32_t> variables( count );
	for ( std::uint32_t i = 0; i < count; ++i )
	{
		variables[i] = i;
	}
	for ( const Segment& segment : segments )
	{
		const lw_timed_piece piece = { 0, 1, segment.degree, segment.points.data() };
		lw_track track = {};
		track.variables = variables.data();
		track.variable_count = count;
		track.pieces = &piece;
		track.piece_count = 1;
		track.tolerance = tolerance.empty() ? nullptr : tolerance.data();
		const lw_clock clock = { &track, 1, segment.points.data() };
		lw_region_result r;
		require( lw_region_timed( constraint.region.get(), &clock, nullptr, 0, 1, &r ), constraint.element.c_str() );
		if ( r.verdict != LW_VERDICT_FREE )
		{
			proof.verdict = r.verdict;
			proof.time = segment.begin + r.time * segment.seconds;
			proof.error = lw_region_limit_name( r.limit );
			proof.value = r.value;
			proof.excess = r.excess;
			return proof;
		}
	}
	return proof;
}

/// A polynomial within a range.
struct Range
{
	double lower, upper, tolerance;
};

/// @param points control points @param from, to the part of the segment that they are of
/// @return FREE: within the range, tolerance and rounding included; else `at` is the place
lw_verdict within( const std::vector<double>& points, const Range& range, double from, double to, int halvings, double& at )
{
	const auto [least, most] = std::minmax_element( points.begin(), points.end() );
	const double off = range.tolerance + relative_rounding * std::max( std::fabs( *least ), std::fabs( *most ) );
	if ( *least - off >= range.lower && *most + off <= range.upper )
	{
		return LW_VERDICT_FREE;
	}
	const double own = off - range.tolerance;
	for ( const bool end : { false, true } )
	{
		const double value = end ? points.back() : points.front();
		if ( value + own < range.lower || value - own > range.upper )
		{
			at = end ? to : from;
			return LW_VERDICT_BLOCKED;
		}
	}
	at = from;
	if ( halvings == most_halvings )
	{
		return LW_VERDICT_UNDECIDED;
	}
	std::vector<double> left, right = points, rest = points;
	for ( std::size_t n = points.size(); n > 0; --n )
	{
		left.push_back( rest.front() );
		right[n - 1] = rest[n - 1];
		for ( std::size_t i = 0; i + 1 < n; ++i )
		{
			rest[i] = 0.5 * ( rest[i] + rest[i + 1] );
		}
	}
	const double middle = 0.5 * ( from + to );
	const lw_verdict first = within( left, range, from, middle, halvings + 1, at );
	return first == LW_VERDICT_FREE ? within( right, range, middle, to, halvings + 1, at ) : first;
}

JointRange rangeOf( const io::Problem& problem, const io::PathConstraints& path, const io::JointGoal& goal )
{
	JointRange range;
	range.element = "path_constraints.joint_constraints " + goal.joint;
	range.joint = goal.joint;
	if ( !( goal.tolerance_above + goal.tolerance_below > 0 ) )
	{
		throw io::Error(
		    path.file, range.element, "tolerances of 0 leave no room", "give tolerance_above or tolerance_below" );
	}
	const std::uint32_t variable = variableOf( problem.robot.get(), goal.joint );
	if ( variable == LW_INVALID_INDEX )
	{
		throw io::Error( path.file, range.element, "the robot has no such joint", "name one of its joints" );
	}
	const auto entry = std::find( problem.variables.begin(), problem.variables.end(), variable );
	range.moves = entry != problem.variables.end();
	range.entry = static_cast<std::size_t>( entry - problem.variables.begin() );
	range.stands = problem.reference[variable];
	range.wraps = lw_robot_variable( problem.robot.get(), variable ).wraps;
	range.middle = goal.position;
	range.below = goal.tolerance_below;
	range.above = goal.tolerance_above;
	return range;
}

ConstraintProof proveJoint( const io::Problem& problem, const JointRange& joint, const std::vector<Segment>& segments,
    const std::vector<double>& tolerance )
{
	ConstraintProof proof;
	proof.element = joint.element;
	proof.error = "joint " + joint.joint;
	const std::size_t v = joint.entry;
	for ( const Segment& segment : segments )
	{
		std::vector<double> points;
		for ( unsigned k = 0; k <= segment.degree; ++k )
		{
			points.push_back( joint.moves ? segment.points[k * problem.variables.size() + v] : joint.stands );
		}
		const double turns = joint.turnsAt( points.front() );
		const Range range = { joint.middle + turns - joint.below, joint.middle + turns + joint.above,
		    joint.moves && !tolerance.empty() ? tolerance[v] : 0 };
		double at = 0;
		proof.verdict = within( points, range, 0, 1, 0, at );
		if ( proof.verdict != LW_VERDICT_FREE )
		{
			proof.time = segment.begin + at * segment.seconds;
			const double value = joint.moves ? stateAt( { segment }, proof.time )[v] : points.front();
			proof.value = value - turns;
			proof.excess = std::max( range.lower - value, value - range.upper );
			return proof;
		}
	}
	return proof;
}

} // namespace

double JointRange::turnsAt( double value ) const
{
	return wraps ? 2 * M_PI * std::round( ( value - middle ) / ( 2 * M_PI ) ) : 0;
}

BoundConstraints::BoundConstraints( const io::Problem& problem, const io::PathConstraints& path ) : m_problem( &problem )
{
	for ( const io::JointGoal& goal : path.joints )
	{
		m_joints.push_back( rangeOf( problem, path, goal ) );
	}
	for ( const io::PositionGoal& goal : path.positions )
	{
		const lw_region_def def = defOf( problem, path, goal );
		m_poses.push_back( { goal.element, def, regionOf( problem, path, goal.element, def ) } );
	}
	for ( const io::OrientationGoal& goal : path.orientations )
	{
		const bool free = *std::min_element( goal.tolerance.begin(), goal.tolerance.end() ) >= M_PI;
		const lw_region_def def = defOf( problem, path, goal );
		m_poses.push_back( { goal.element, def, free ? RegionHandle() : regionOf( problem, path, goal.element, def ) } );
	}
}

std::vector<ConstraintProof> BoundConstraints::prove(
    const std::vector<Segment>& segments, const std::vector<double>& tolerance ) const
{
	std::vector<ConstraintProof> proofs;
	for ( const JointRange& joint : m_joints )
	{
		proofs.push_back( proveJoint( *m_problem, joint, segments, tolerance ) );
	}
	for ( const PoseConstraint& pose : m_poses )
	{
		proofs.push_back( proveRegion( *m_problem, pose, segments, tolerance ) );
	}
	return proofs;
}

bool BoundConstraints::areKept( const Segment& segment ) const
{
	const std::vector<Segment> one = { segment };
	const auto kept = [&]( const ConstraintProof& proof ) { return proof.verdict == LW_VERDICT_FREE; };
	return std::all_of( m_joints.begin(), m_joints.end(),
	           [&]( const JointRange& joint ) { return kept( proveJoint( *m_problem, joint, one, {} ) ); } ) &&
	       std::all_of( m_poses.begin(), m_poses.end(),
	           [&]( const PoseConstraint& pose ) { return kept( proveRegion( *m_problem, pose, one, {} ) ); } );
}

std::vector<ConstraintProof> proveConstraints( const io::Problem& problem, const io::PathConstraints& path,
    const std::vector<Segment>& segments, const std::vector<double>& tolerance )
{
	return BoundConstraints( problem, path ).prove( segments, tolerance );
}

bool areKept( const std::vector<ConstraintProof>& proofs )
{
	return std::all_of(
	    proofs.begin(), proofs.end(), []( const ConstraintProof& proof ) { return proof.verdict == LW_VERDICT_FREE; } );
}

std::string describe( const std::vector<ConstraintProof>& proofs )
{
	std::string text;
	for ( const ConstraintProof& proof : proofs )
	{
		text += describe( proof );
	}
	return text;
}

std::string describe( const ConstraintProof& proof )
{
	switch ( proof.verdict )
	{
	case LW_VERDICT_FREE:
		return fmt::format( "constraint  {}: kept at all times, proved\n", proof.element );
	case LW_VERDICT_BLOCKED:
		return fmt::format( "constraint  {}: broken at {:.4f} s: {} is {:.6g}, by {:.3g} beyond its limit\n", proof.element,
		    proof.time, proof.error, proof.value, proof.excess );
	default:
		return fmt::format( "constraint  {}: not proved at {:.4f} s: {} of {:.6g} is too near to its limit\n", proof.element,
		    proof.time, proof.error, proof.value );
	}
}

} // namespace leeway::motions
