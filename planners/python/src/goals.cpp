// SPDX-License-Identifier: BSD-3-Clause
// Checker.goal_states(): inverse kinematics, states that are proved free.
#include "objects.hpp"

#include "leeway/ik/goal_states.hpp"

#include <nanobind/stl/string.h>

#include <limits>

namespace leeway::python
{

namespace
{

using namespace nb::literals;

io::Request requestOf( const PyChecker& checker, const std::string& link, const lw_transform& pose, const std::string& frame,
    double position_tolerance, double angle_tolerance )
{
	io::Request request;
	request.file = "goal_states";
	request.group = checker.problem->group;
	io::PositionGoal position;
	position.link = link;
	position.frame = frame;
	position.element = "link " + link;
	io::GoalRegion region;
	region.type = io::GoalRegion::Type::Sphere;
	region.size = { position_tolerance, 0, 0 };
	region.pose = pose;
	position.regions.push_back( region );
	request.goal_positions.push_back( position );
	io::OrientationGoal orientation;
	orientation.link = link;
	orientation.frame = frame;
	orientation.element = "link " + link;
	lw_transform_to_quaternion( &pose, orientation.quaternion.data() );
	orientation.tolerance = { angle_tolerance, angle_tolerance, angle_tolerance };
	orientation.parameterization = io::OrientationGoal::Parameterization::rotation_vector;
	request.goal_orientations.push_back( orientation );
	return request;
}

nb::object goalStates( const PyChecker& checker, const std::string& link, const Doubles& pose, const std::string& frame,
    double position_tolerance, double angle_tolerance, const Whole& count, const Whole& seed, double min_d,
    const std::string& check )
{
	const io::Request request =
	    requestOf( checker, link, poseOf( pose, "pose" ), frame, position_tolerance, angle_tolerance );
	ik::Options options;
	options.seed = seed.seed();
	options.states = count.in( "count", 1, std::numeric_limits<std::uint32_t>::max() );
	options.min_d = min_d;
	options.flags = checkFlags( check );
	ik::GoalStates found;
	{
		const nb::gil_scoped_release unlocked;
		found = ik::findGoalStates( *checker.model, *checker.problem, request, options );
	}
	const NewArray<double> states( { found.states.size(), checker.variables() } );
	for ( std::size_t i = 0; i < found.states.size(); ++i )
	{
		std::copy( found.states[i].begin(), found.states[i].end(), states.data + i * checker.variables() );
	}
	const std::string message = found.problem.empty() ? "" : found.problem + "; " + found.remedy;
	return result( "GoalStates", nb::make_tuple( states.object, message.c_str() ) );
}

} // namespace

void bindGoals( nb::class_<PyChecker>& type )
{
	const ik::Options defaults;
	type.def( "goal_states", &goalStates, "link"_a, "pose"_a, nb::kw_only(), "frame"_a = "", "position_tolerance"_a = 1e-4,
	    "angle_tolerance"_a = 1e-3, "count"_a.none() = defaults.states, "seed"_a.none() = defaults.seed, "min_d"_a = 0.0,
	    "check"_a = "both",
	    nb::sig(
	        "def goal_states(self, link: str, pose: numpy.typing.ArrayLike, *, frame: str = '', position_tolerance: float = 0.0001, "
	        "angle_tolerance: float = 0.001, count: int = 8, seed: int = 1, min_d: float = 0.0, check: str = 'both') -> "
	        "leeway.results.GoalStates" ),
	    "Inverse kinematics: states in which a link, or an attached object, has a pose, each proved free; goals for plan().\n\n"
	    "pose: a 4 x 4 matrix or x y z qx qy qz qw in `frame` (empty: the planning frame), within a ball of position_tolerance metres\n"
	    "and a turn of angle_tolerance radians about each axis (pi: any turn). Returns (states float64 [k, dof] with k <= count, the\n"
	    "nearest to `start` first; message with the reason if there is none). Equal seeds give equal states. Raises InputError." );
}

} // namespace leeway::python
