// SPDX-License-Identifier: BSD-3-Clause
// Inverse kinematics: Checker.goal_states(), states that are proved free; leeway.Inverse, one frame's poses in batches. Checker.plan_line(): lines
// and arcs of a link's frame.
#include "constrained.hpp"

#include "leeway/ik/inverse.hpp"
#include "leeway/lines/lines.hpp"

#include <nanobind/stl/string.h>

#include <atomic>
#include <cmath>
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

// ---- Inverse ------------------------------------------------------------------------------------------------------

constexpr std::size_t block_of_poses = 8;

/// leeway.Inverse: immutable, one solver for each thread that works.
struct PyInverse
{
	PyInverse( const PyChecker& of, const io::Frame& tip_frame, const io::Frame& base_frame )
	    : checker( of ), tip( tip_frame ), base( base_frame )
	{
		solvers.push_back( take() );
	}
	std::unique_ptr<ik::Inverse> take()
	{
		{
			const std::lock_guard<std::mutex> lock( mutex );
			if ( !solvers.empty() )
			{
				std::unique_ptr<ik::Inverse> solver = std::move( solvers.back() );
				solvers.pop_back();
				return solver;
			}
		}
		return std::make_unique<ik::Inverse>( *checker.model, *checker.problem, tip, base );
	}
	void giveBack( std::unique_ptr<ik::Inverse> solver )
	{
		const std::lock_guard<std::mutex> lock( mutex );
		solvers.push_back( std::move( solver ) );
	}

	const PyChecker checker;
	const io::Frame tip, base;
	std::mutex mutex;
	std::vector<std::unique_ptr<ik::Inverse>> solvers;
};

/// Start states: one for each pose, or one for all; none: that of the checker.
struct Starts
{
	Starts( const nb::object& given, const PyChecker& checker, std::size_t poses )
	{
		if ( given.is_none() )
		{
			return;
		}
		if ( !nb::try_cast( given, numbers ) )
		{
			throw nb::value_error( "start: is no array of numbers" );
		}
		rows = rowsOf( numbers, checker.variables(), "start", "variables of the group" );
		if ( !rows.single && rows.count != poses )
		{
			const std::string text = "start: " + std::to_string( rows.count ) + " states for " + std::to_string( poses ) +
			                         " poses; give one for each, or one for all";
			throw nb::value_error( text.c_str() );
		}
		for ( std::size_t i = 0; i < rows.count; ++i )
		{
			for ( std::size_t v = 0; v < rows.width; ++v )
			{
				if ( !std::isfinite( rows[i][v] ) )
				{
					const std::string text = "start[" + std::to_string( i ) + "]: entry " + std::to_string( v ) +
					                         " is not finite; correct the state";
					throw nb::value_error( text.c_str() );
				}
			}
		}
	}
	const double* operator[]( std::size_t i ) const { return rows.data == nullptr ? nullptr : rows[rows.single ? 0 : i]; }
	Doubles numbers;
	Rows rows;
};

nb::object arraysOf( const PyChecker& checker, const std::vector<ik::InverseStates>& all, bool clearances )
{
	const std::size_t dof = checker.variables();
	const NewArray<std::int64_t> offsets( { all.size() + 1 } );
	const NewArray<std::uint8_t> failures( { all.size() } );
	const NewArray<double> metres( { all.size() } ), radians( { all.size() } );
	nb::list messages;
	offsets.data[0] = 0;
	for ( std::size_t i = 0; i < all.size(); ++i )
	{
		const ik::InverseStates& found = all[i];
		offsets.data[i + 1] = offsets.data[i] + static_cast<std::int64_t>( found.states.size() );
		failures.data[i] = static_cast<std::uint8_t>( found.failure );
		metres.data[i] = found.metres;
		radians.data[i] = found.radians;
		messages.append( found.failure == ik::Failure::NONE ? std::string() : found.problem + "; " + found.remedy );
	}
	const auto count = static_cast<std::size_t>( offsets.data[all.size()] );
	const NewArray<double> states( { count, dof } ), lower( { clearances ? count : 0 } ),
	    upper( { clearances ? count : 0 } );
	std::size_t k = 0;
	for ( const ik::InverseStates& found : all )
	{
		for ( const ik::InverseState& state : found.states )
		{
			std::copy( state.q.begin(), state.q.end(), states.data + k * dof );
			if ( clearances )
			{
				lower.data[k] = state.lower;
				upper.data[k] = state.upper;
			}
			++k;
		}
	}
	return result( "InverseStates",
	    nb::make_tuple( offsets.object, states.object, clearances ? lower.object : nb::none(),
	        clearances ? upper.object : nb::none(), failures.object, metres.object, radians.object, messages ) );
}

nb::object solve( PyInverse& self, const Doubles& poses, const nb::object& start, const Whole& count,
    const nb::object& check, double min_d, double max_d, bool turns, const Whole& searches, double patience, double apart,
    const Whole& seed, const Whole& threads )
{
	const std::vector<lw_transform> wanted = posesOf( poses, "poses" );
	const Starts starts( start, self.checker, wanted.size() );
	ik::InverseOptions options;
	options.states = count.in( "count", 1, std::numeric_limits<std::uint32_t>::max() );
	options.searches = searches.in( "searches", 1, std::numeric_limits<std::uint32_t>::max() );
	options.patience = patience;
	options.apart = apart;
	options.seed = seed.seed();
	options.turns = turns;
	options.clearances = !check.is_none();
	options.flags = options.clearances ? checkFlags( nb::cast<std::string>( check ) ) : LW_CHECK_BOTH;
	options.min_d = min_d;
	options.max_d = max_d;
	std::vector<ik::InverseStates> found( wanted.size() );
	inBlocks( *self.checker.queries, wanted.size(), block_of_poses, threads.threads(),
	    [&]( lw_query* query, std::size_t begin, std::size_t end )
	    {
		    std::unique_ptr<ik::Inverse> solver = self.take();
		    for ( std::size_t i = begin; i < end; ++i )
		    {
			    found[i] = solver->solve( wanted[i], starts[i], options, query );
		    }
		    self.giveBack( std::move( solver ) );
	    } );
	return arraysOf( self.checker, found, options.clearances );
}

// ---- lines --------------------------------------------------------------------------------------------------------

/// Poses in order; a tuple of two is a pose and the place through which an arc leads there.
std::vector<lines::Waypoint> waypointsOf( const nb::object& poses )
{
	std::vector<lines::Waypoint> waypoints;
	for ( const nb::handle item : poses )
	{
		const bool arc = nb::isinstance<nb::tuple>( item ) && nb::len( item ) == 2;
		const nb::object pose = arc ? nb::object( item[0] ) : nb::borrow( item );
		waypoints.push_back( { poseOf( nb::cast<Doubles>( pose ), "poses" ) } );
		if ( arc )
		{
			const Doubles via = nb::cast<Doubles>( nb::object( item[1] ) );
			const double* place = vectorOf( via, 3, "poses", "numbers of a place" );
			waypoints.back().via = lw_vec3{ place[0], place[1], place[2] };
		}
	}
	return waypoints;
}

nb::object lineOf( const PyChecker& checker, const lines::Result& line )
{
	const std::size_t points = line.solved ? line.segments.size() + 1 : 0, count = checker.variables();
	const NewArray<double> times( { points } ), positions( { points, count } ), velocities( { points, count } );
	for ( std::size_t i = 0; i < points; ++i )
	{
		// the first point of a cubic, or the last one of the last
		const bool last = i + 1 == points;
		const motions::Segment& s = line.segments[last ? i - 1 : i];
		const double* p = s.points.data() + ( last ? 3 * count : 0 );
		const double* q = s.points.data() + ( last ? 2 * count : count );
		times.data[i] = s.begin + ( last ? s.seconds : 0 );
		for ( std::size_t v = 0; v < count; ++v )
		{
			positions.data[i * count + v] = p[v];
			velocities.data[i * count + v] = 3 * ( last ? p[v] - q[v] : q[v] - p[v] ) / s.seconds;
		}
	}
	const std::string message = line.solved ? std::string() : lines::describe( *checker.problem, line );
	return result( "Line", nb::make_tuple( line.solved, times.object, positions.object, velocities.object,
	                           line.position_error, line.angle_error, line.attempts, message.c_str() ) );
}

/// blend=: a radius for all corners between two lines, or one for each pose.
void takeRadii( const nb::object& blend, lines::Task& task )
{
	std::vector<lines::Waypoint>& waypoints = task.waypoints;
	const Doubles numbers = nb::cast<Doubles>( blend );
	if ( nb::hasattr( blend, "__len__" ) )
	{
		const double* radii = vectorOf( numbers, waypoints.size(), "blend", "poses" );
		for ( std::size_t i = 0; i < waypoints.size(); ++i )
		{
			waypoints[i].blend = radii[i];
		}
		return;
	}
	for ( std::size_t i = task.any_start ? 1 : 0; i + 1 < waypoints.size(); ++i )
	{
		waypoints[i].blend = waypoints[i].via || waypoints[i + 1].via ? 0 : *numbers.data();
	}
}

nb::object planLine( const PyChecker& checker, const std::string& link, const nb::object& poses, const nb::object& start,
    const nb::object& tip, const std::string& frame, const nb::object& free_axis, const nb::object& blend, double tolerance,
    double angle, double speed, const nb::object& velocity, const nb::object& acceleration, const Whole& seed,
    const Whole& attempts, double min_d, const std::string& check )
{
	const io::Problem& problem = *checker.problem;
	lines::Task task;
	task.tip = io::findFrame( problem, link, "plan_line", "link" );
	const lw_transform offset = poseOrIdentity( tip, "tip" );
	task.tip.pose = lw_transform_multiply( &task.tip.pose, &offset );
	task.base = io::findFrame( problem, frame, "plan_line", "frame" );
	task.waypoints = waypointsOf( poses );
	task.any_start = start.is_none();
	takeRadii( blend, task );
	if ( !task.any_start )
	{
		const Doubles numbers = nb::cast<Doubles>( start );
		const double* values = vectorOf( numbers, checker.variables(), "start", "variables of the group" );
		task.start.assign( values, values + checker.variables() );
	}
	if ( !free_axis.is_none() )
	{
		const Doubles numbers = nb::cast<Doubles>( free_axis );
		const double* axis = vectorOf( numbers, 3, "free_axis", "numbers" );
		task.free_axis = lw_vec3{ axis[0], axis[1], axis[2] };
	}
	task.tolerance = tolerance;
	task.angle = angle;
	task.speed = speed;
	const double slack = lw_edge_def_default().slack;
	lines::Settings settings{ settingsOf( checker, min_d, slack, check, seed, velocity, acceleration ) };
	settings.attempts = attempts.in( "attempts", 1, std::numeric_limits<std::uint32_t>::max() );
	lines::Result line;
	std::atomic<bool> stopped = false;
	settings.stop = [&stopped] { return stopped.load(); };
	workInterruptibly(
	    [&] { line = lines::planLines( *checker.model, problem, task, settings ); }, [&stopped] { stopped = true; } );
	return lineOf( checker, line );
}

void bindLine( nb::class_<PyChecker>& type )
{
	const lines::Task task;
	const lines::Settings settings;
	type.def( "plan_line", &planLine, "link"_a, "poses"_a, nb::kw_only(), "start"_a = nb::none(), "tip"_a = nb::none(),
	    "frame"_a = "", "free_axis"_a = nb::none(), "blend"_a = 0.0, "tolerance"_a = task.tolerance, "angle"_a = task.angle,
	    "speed"_a = HUGE_VAL, "velocity"_a = nb::none(), "acceleration"_a = nb::none(), "seed"_a.none() = settings.seed,
	    "attempts"_a.none() = settings.attempts, "min_d"_a = 0.0, "check"_a = "both",
	    nb::sig(
	        "def plan_line(self, link: str, poses: typing.Sequence, *, start: numpy.typing.ArrayLike | None = None, "
	        "tip: numpy.typing.ArrayLike | None = None, frame: str = '', free_axis: numpy.typing.ArrayLike | None = None, "
	        "blend: numpy.typing.ArrayLike = 0.0, tolerance: float = 0.0001, angle: float = 0.0017, speed: float = float('inf'), "
	        "velocity: numpy.typing.ArrayLike | None = None, acceleration: numpy.typing.ArrayLike | None = None, "
	        "seed: int = 1, attempts: int = 100, min_d: float = 0.0, check: str = 'both') -> leeway.results.Line" ),
	    "A link's frame (or `tip` in it, a pose) goes straight from pose to pose, by cubics of the joints that are proved to stay on the\n"
	    "line, free, and within limits, at all times.\n\n"
	    "poses: each as of goal_states(), in `frame`; a tuple (pose, place) goes along the arc of a circle through the place. With `start`,\n"
	    "float64 [dof], the line begins there; without, at the first pose, in any state that has it. free_axis: of the tip, about which it may\n"
	    "turn. The robot rests at each pose; blend: metres, from which on corners between two lines are rounded by a circle without a rest, one\n"
	    "number, or one for each pose (0: rest). tolerance: metres, of each coordinate; angle: radians; speed: metres per second at most. velocity, acceleration: float64 [dof]\n"
	    "limits (None: of the robot; 1). Returns Line; trajectory(times, positions, velocities) proves the same motion. Equal seeds give\n"
	    "equal answers. Ctrl-C ends it. Raises InputError." );
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
	bindLine( type );
	bindConstrained( type );
}

void bindInverses( nb::module_& module )
{
	nb::class_<PyInverse> type( module, "Inverse",
	    "Inverse kinematics of one frame: the states of a checker's group in which a link's frame has a pose, one state or all branches.\n"
	    "Any joints but floating ones, in any number. Threads may share it. Goals with tolerances: Checker.goal_states()." );
	type.def(
	    "__init__",
	    []( PyInverse* self, const PyChecker& checker, const std::string& link, const nb::object& tip,
	        const std::string& frame )
	    {
		    const io::Problem& problem = *checker.problem;
		    io::Frame tip_frame = io::findFrame( problem, link, "Inverse", "link" );
		    const lw_transform offset = poseOrIdentity( tip, "tip" );
		    tip_frame.pose = lw_transform_multiply( &tip_frame.pose, &offset );
		    new ( self ) PyInverse( checker, tip_frame, io::findFrame( problem, frame, "Inverse", "frame" ) );
	    },
	    "checker"_a, "link"_a, nb::kw_only(), "tip"_a = nb::none(), "frame"_a = "",
	    nb::sig(
	        "def __init__(self, checker: Checker, link: str, *, tip: numpy.typing.ArrayLike | None = None, frame: str = '') -> None" ),
	    "link: whose frame has the poses, or an attached object; tip: a pose in it, None = its origin. frame: of the poses, a link that may\n"
	    "move itself or an object; empty: the planning frame. Raises InputError if no joint of the group moves the one in the other." );
	const ik::InverseOptions defaults;
	type.def( "solve", &solve, "poses"_a, "start"_a = nb::none(), nb::kw_only(), "count"_a.none() = defaults.states,
	    "check"_a = nb::none(), "min_d"_a = defaults.min_d, "max_d"_a = defaults.max_d, "turns"_a = defaults.turns,
	    "searches"_a.none() = defaults.searches, "patience"_a = defaults.patience, "apart"_a = defaults.apart,
	    "seed"_a.none() = defaults.seed, "threads"_a.none() = 1,
	    nb::sig(
	        "def solve(self, poses: numpy.typing.ArrayLike, start: numpy.typing.ArrayLike | None = None, *, count: int = 16, "
	        "check: str | None = None, min_d: float = 0.0, max_d: float = float('inf'), turns: bool = False, "
	        "searches: int = 500, patience: float = 8.0, apart: float = 0.01, seed: int = 1, threads: int = 1) -> "
	        "leeway.results.InverseStates" ),
	    "States that have the poses to 1e-9 m and 1e-9 rad, by the same kinematics as Robot.fk(), within the joint limits.\n\n"
	    "poses: float64 [n, 7], x y z qx qy qz qw; [n, 4, 4]; or one of them. start: float64 [n, dof] or [dof], None = the checker's\n"
	    "start: searches begin there, and the nearest state to it comes first. count: states for each pose at most; 1 ends with the first, to\n"
	    "which the start leads if it leads to any. Up to six joints: all branches that random starts find; more: samples of the family.\n"
	    "check: \"both\", \"environment\" or \"self\" certifies clearances (metres, exact between min_d and max_d) and puts states above min_d\n"
	    "first. turns: joints with limits a whole turn apart give a state for each turn, else the one nearest to the start. searches:\n"
	    "descents for each pose, at most; patience: how long they go on without a further state; apart: two states nearer in every\n"
	    "variable are one. Equal seeds give equal states, whatever the batch and the threads (0 = one per core). Returns InverseStates.\n"
	    "Raises ValueError for a pose or start that is not finite, or a quaternion of 0." );
	type.def( "__reduce__", &refusePickle );
}

} // namespace leeway::python
