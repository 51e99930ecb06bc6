// SPDX-License-Identifier: BSD-3-Clause
// leeway.Guard: a motion that runs while its world changes.
#include "leeway/motions/guard.hpp"
#include "objects.hpp"

#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>

#include <cmath>
#include <deque>

namespace leeway::python
{

namespace
{

using namespace nb::literals;

[[noreturn]] void refuse( const std::string& text )
{
	throw nb::value_error( text.c_str() );
}

/// One value for each variable: of an array of them, or the same for all. None: empty.
std::vector<double> eachOf( const PyChecker& checker, const nb::object& given, const char* name )
{
	if ( given.is_none() )
	{
		return {};
	}
	if ( nb::isinstance<nb::float_>( given ) || nb::isinstance<nb::int_>( given ) )
	{
		return std::vector<double>( checker.variables(), nb::cast<double>( given ) );
	}
	const Doubles numbers = nb::cast<Doubles>( given );
	const double* values = vectorOf( numbers, checker.variables(), name, "variables of the group" );
	return { values, values + checker.variables() };
}

/// The guard, and the worlds that its answers are about. Publishing and asking have a lock each, so a writer never waits for a proof.
class PyGuard
{
public:
	PyGuard(
	    const PyChecker& checker, const std::vector<motions::Segment>& segments, const motions::GuardSettings& settings )
	    : m_guard( *checker.problem, segments, settings ), m_worlds{ { 0, checker.problem } }
	{
	}

	void publish( const PyChecker& checker, std::uint64_t stamp )
	{
		const nb::gil_scoped_release unlocked;
		const std::lock_guard<std::mutex> lock( m_publishing );
		m_guard.publish( checker.problem->checker, stamp );
		const std::lock_guard<std::mutex> names( m_names );
		m_worlds.push_back( { stamp, checker.problem } );
		if ( m_worlds.size() > kept )
		{
			m_worlds.pop_front();
		}
	}

	template <typename Question> auto asked( const Question& question )
	{
		const nb::gil_scoped_release unlocked;
		const std::lock_guard<std::mutex> lock( m_asking );
		return question( m_guard );
	}

	/// The names of a pair; None if there is none, or the world was published too long ago.
	nb::object namesOf( std::uint64_t stamp, bool self, const lw_clearance& pair )
	{
		std::shared_ptr<const io::Problem> problem;
		{
			const std::lock_guard<std::mutex> lock( m_names );
			for ( const World& world : m_worlds )
			{
				problem = world.stamp == stamp ? world.problem : problem;
			}
		}
		if ( pair.kind == LW_CLEARANCE_UNKNOWN || pair.a == LW_INVALID_INDEX || problem == nullptr )
		{
			return nb::none();
		}
		const lw_checker* checker = problem->checker.get();
		const motions::Named named = self ? motions::nameSelf( checker, pair ) : motions::nameEnvironment( checker, pair );
		return nb::make_tuple( named.first, named.second );
	}
	double end() const { return m_guard.end(); }

private:
	struct World
	{
		std::uint64_t stamp;
		std::shared_ptr<const io::Problem> problem;
	};
	static constexpr std::size_t kept = 16;
	motions::Guard m_guard;
	std::mutex m_publishing, m_asking, m_names;
	std::deque<World> m_worlds; ///< the last ones
};

nb::object answerOf( PyGuard& guard, const lw_guard_answer& a )
{
	const bool known = a.pair.kind != LW_CLEARANCE_UNKNOWN;
	const double none = std::nan( "" );
	return result( "GuardAnswer",
	    nb::make_tuple( a.verdict, a.stamp, a.now, a.proved_until, a.time, guard.namesOf( a.stamp, a.self, a.pair ),
	        known ? a.pair.lower : none, known ? a.pair.upper : none ) );
}

nb::object speedOf( PyGuard& guard, double now, double age, const lw_separation& separation, double highest, double budget )
{
	const lw_guard_scale s =
	    guard.asked( [&]( motions::Guard& g ) { return g.speed( separation, now, age, highest, budget ); } );
	return result( "GuardSpeed", nb::make_tuple( s.scale, s.separation, s.until, s.stamp,
	                                 guard.namesOf( s.stamp, s.next.self, s.next.pair ), s.proofs ) );
}

void bindQuestions( nb::class_<PyGuard>& type )
{
	const double unlimited = motions::Guard::no_budget;
	type.def(
	    "ask",
	    []( PyGuard& self, double now, double budget )
	    { return answerOf( self, self.asked( [&]( motions::Guard& g ) { return g.ask( now, budget ); } ) ); },
	    "now"_a, "budget"_a = unlimited,
	    nb::sig( "def ask(self, now: float, budget: float = float('inf')) -> leeway.results.GuardAnswer" ),
	    "Is the motion still free from `now` (seconds of the motion) on, in the newest world? budget: microseconds, after which the answer is\n"
	    "UNDECIDED; ask again. A call about the same world costs nothing." );
	type.def(
	    "stop",
	    []( PyGuard& self, double start, double budget )
	    { return answerOf( self, self.asked( [&]( motions::Guard& g ) { return g.stop( start, budget ); } ) ); },
	    "start"_a, "budget"_a = unlimited,
	    nb::sig( "def stop(self, start: float, budget: float = float('inf')) -> leeway.results.GuardAnswer" ),
	    "Is the robot free to be told to stop at `start`? FREE: proved until it stands, at `time`. Needs decelerations. budget: as for ask()." );
	type.def(
	    "brake_by",
	    []( PyGuard& self, double now, double until, double step, double budget )
	    { return self.asked( [&]( motions::Guard& g ) { return g.brakeBy( now, until, step, budget ); } ); },
	    "now"_a, "until"_a, "step"_a = 1e-3, "budget"_a = unlimited,
	    nb::sig(
	        "def brake_by(self, now: float, until: float, step: float = 0.001, budget: float = float('inf')) -> float" ),
	    "Seconds: the latest of now, now + step, ... until, at which a stop is still proved; NaN if none is, or the budget ended before. until:\n"
	    "proved_until of ask()." );
	const lw_separation usual = lw_separation_default();
	type.def(
	    "speed",
	    []( PyGuard& self, double now, double age, double speed, double intrusion, double reaction, double deceleration,
	        double highest, std::uint32_t grid, double budget )
	    {
		    lw_separation separation = lw_separation_default();
		    separation.speed = speed;
		    separation.intrusion = intrusion;
		    separation.reaction = reaction;
		    separation.deceleration = deceleration;
		    separation.grid = grid;
		    return speedOf( self, now, age, separation, highest, budget );
	    },
	    "now"_a, "age"_a = 0.0, nb::kw_only(), "speed"_a = usual.speed, "intrusion"_a = 0.0, "reaction"_a = 0.1,
	    "deceleration"_a = usual.deceleration, "highest"_a = 1.0, "grid"_a = usual.grid, "budget"_a = unlimited,
	    nb::sig(
	        "def speed(self, now: float, age: float = 0.0, *, speed: float = 1.6, intrusion: float = 0.0, reaction: float = 0.1, "
	        "deceleration: float = 1.0, highest: float = 1.0, grid: int = 64, budget: float = float('inf')) -> leeway.results.GuardSpeed" ),
	    "How fast may the robot go on beside people? The largest scale of its speed at which no object of the world comes as near as `intrusion`\n"
	    "(metres) until the robot stands, if the objects move by at most `speed` (metres per second) and were seen `age` seconds ago. The scale falls by\n"
	    "`deceleration` per second after `reaction` seconds. Give people a guard of their own: all objects count. ISO/TS 15066: core/docs/guard.md." );
}

} // namespace

void bindGuards( nb::module_& module )
{
	nb::class_<PyGuard> type( module, "Guard",
	    "A motion that runs while its world changes: is the rest still proved? Seconds of the motion, metres, radians.\n"
	    "One thread publishes worlds, another one asks: neither waits for the other, and both leave the interpreter to others." );
	type.def(
	    "__init__",
	    []( PyGuard* self, const PyChecker& checker, const Doubles& times, const nb::object& positions,
	        const nb::object& velocities, const nb::object& accelerations, double min_d, double slack,
	        const std::string& check, const nb::object& tolerance, double lag, double window, double contact_resolution,
	        const nb::object& deceleration, double reaction, std::uint32_t spare_shapes, std::uint32_t spare_bodies )
	    {
		    const motions::TrajectoryFile file = trajectoryOf( checker, times, positions, velocities, accelerations );
		    motions::GuardSettings settings;
		    settings.edge.min_d = min_d;
		    settings.edge.slack = slack;
		    settings.edge.flags = checkFlags( check );
		    settings.tolerance = eachOf( checker, tolerance, "tolerance" );
		    settings.lag = lag;
		    settings.window = window;
		    settings.contact_resolution = contact_resolution;
		    settings.deceleration = eachOf( checker, deceleration, "deceleration" );
		    settings.reaction = reaction;
		    settings.spare_shapes = spare_shapes;
		    settings.spare_bodies = spare_bodies;
		    if ( !( min_d >= 0 && slack > 0 ) )
		    {
			    refuse( "min_d, slack: give a margin of 0 or more, and a slack above 0" );
		    }
		    const nb::gil_scoped_release unlocked;
		    new ( self ) PyGuard( checker,
		        motions::segmentsOf( *checker.problem, file, motions::Interpolation::automatic, file.points.front().time ),
		        settings );
	    },
	    "checker"_a, "times"_a, "positions"_a, "velocities"_a = nb::none(), "accelerations"_a = nb::none(), nb::kw_only(),
	    "min_d"_a = 0.0, "slack"_a = 1e-3, "check"_a = "both", "tolerance"_a = nb::none(), "lag"_a = 0.0, "window"_a = 0.5,
	    "contact_resolution"_a = 1e-3, "deceleration"_a = nb::none(), "reaction"_a = 0.0, "spare_shapes"_a = 256,
	    "spare_bodies"_a = 8,
	    nb::sig(
	        "def __init__(self, checker: Checker, times: numpy.typing.ArrayLike, positions: numpy.typing.ArrayLike, "
	        "velocities: numpy.typing.ArrayLike | None = None, accelerations: numpy.typing.ArrayLike | None = None, *, "
	        "min_d: float = 0.0, slack: float = 0.001, check: str = 'both', tolerance: float | numpy.typing.ArrayLike | None = None, "
	        "lag: float = 0.0, window: float = 0.5, contact_resolution: float = 0.001, "
	        "deceleration: float | numpy.typing.ArrayLike | None = None, reaction: float = 0.0, spare_shapes: int = 256, "
	        "spare_bodies: int = 8) -> None" ),
	    "checker: of the world at the start. times [n], positions, velocities, accelerations [n, dof]: the trajectory, as for\n"
	    "Checker.trajectory(). tolerance, lag: of the controller. window: seconds that are proved at a time. deceleration, reaction: of stops.\n"
	    "spare_shapes, spare_bodies: so many more may later worlds have." );
	type.def( "publish", &PyGuard::publish, "checker"_a, "stamp"_a,
	    "The world has changed: a Checker of it, by World's changes. stamp: int above the last one, such as nanoseconds of the sensor. Raises\n"
	    "InputError if it does not fit; all answers are then UNDECIDED until another world is published." );
	type.def_prop_ro( "end", &PyGuard::end, "Seconds at which the motion ends." );
	bindQuestions( type );
	type.def( "__reduce__", &refusePickle );
}

} // namespace leeway::python
