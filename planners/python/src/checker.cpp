// SPDX-License-Identifier: BSD-3-Clause
// leeway.Checker and leeway.World: a robot in a scene, and scenes that change.
#include "objects.hpp"

#include "leeway/prepare.hpp"

#include <nanobind/stl/map.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <chrono>
#include <limits>
#include <set>

namespace leeway::python
{

namespace
{

using namespace nb::literals;

constexpr double infinity = std::numeric_limits<double>::infinity();
using Allowed = std::vector<std::pair<std::string, std::string>>;

/// leeway.World: it makes checkers.
struct PyWorld
{
	PyWorld( const PyRobot& robot, const io::ProblemOptions& options )
	    : world( std::make_shared<io::World>( *robot.model, options ) ), model( robot.model )
	{
	}
	std::shared_ptr<io::World> world; ///< shared by its checkers
	std::shared_ptr<const io::RobotModel> model;
	PyChecker checker() const
	{
		PyChecker checker( world->problem(), model );
		checker.world = world;
		checker.of_world = checker.problem;
		return checker;
	}
};

/// Other threads may edit the scene once the interpreter's lock is released.
std::unique_ptr<const io::SceneModel> copyOf( const PyScene* scene )
{
	return scene != nullptr ? std::make_unique<const io::SceneModel>( scene->model ) : nullptr;
}

void makeChecker( PyChecker* self, const PyRobot& robot, const PyScene* scene, const std::string& group,
    const nb::object& reference, const Allowed& allowed, const nb::object& margins, const nb::object& padding,
    const PyReach* reach, double min_d, double max_d )
{
	const std::unique_ptr<const io::SceneModel> copy = copyOf( scene );
	const io::ProblemOptions options =
	    optionsOf( robot, copy.get(), { group, reference, allowed, margins, padding, reach, min_d, max_d } );
	const nb::gil_scoped_release unlocked;
	new ( self ) PyChecker( std::make_shared<const io::Problem>( io::buildProblem( *robot.model, options ) ), robot.model );
	self->world = std::make_shared<const io::World>( *robot.model, options, *self->problem );
	self->of_world = self->world->problem();
}

void makeWorld( PyWorld* self, const PyRobot& robot, const PyScene* scene, const std::string& group,
    const nb::object& reference, const Allowed& allowed, const nb::object& margins, const nb::object& padding,
    const PyReach* reach, double min_d, double max_d )
{
	const std::unique_ptr<const io::SceneModel> copy = copyOf( scene );
	const io::ProblemOptions options =
	    optionsOf( robot, copy.get(), { group, reference, allowed, margins, padding, reach, min_d, max_d } );
	const nb::gil_scoped_release unlocked;
	new ( self ) PyWorld( robot, options );
}

nb::object limits( const PyChecker& checker, bool upper )
{
	const NewArray<double> out( { checker.variables() } );
	for ( std::size_t i = 0; i < checker.variables(); ++i )
	{
		const lw_variable_info info = lw_robot_variable( lw_checker_robot( checker.get() ), checker.problem->variables[i] );
		out.data[i] = upper ? info.upper : info.lower;
	}
	return out.object;
}

nb::object wraps( const PyChecker& checker )
{
	const NewArray<bool> out( { checker.variables() } );
	for ( std::size_t i = 0; i < checker.variables(); ++i )
	{
		out.data[i] = lw_robot_variable( lw_checker_robot( checker.get() ), checker.problem->variables[i] ).wraps;
	}
	return out.object;
}

std::vector<std::string> linkNames( const PyChecker& checker )
{
	const lw_robot* robot = lw_checker_robot( checker.get() );
	std::vector<std::string> names;
	for ( std::uint32_t i = 0; i < lw_robot_link_count( robot ); ++i )
	{
		names.emplace_back( lw_robot_link_name( robot, i ) );
	}
	return names;
}

std::vector<std::string> objectNames( const PyChecker& checker )
{
	const lw_scene* scene = lw_checker_scene( checker.get() );
	std::vector<std::string> names;
	for ( std::uint32_t i = 0; scene != nullptr && i < lw_scene_object_count( scene ); ++i )
	{
		names.emplace_back( lw_scene_object_name( scene, i ) );
	}
	return names;
}

/// Names of links, then of objects; the last is empty, so that index -1 is no name.
nb::object pairNames( const PyChecker& checker )
{
	std::vector<std::string> names = linkNames( checker );
	for ( std::string& name : objectNames( checker ) )
	{
		names.push_back( std::move( name ) );
	}
	names.emplace_back();
	return nb::module_::import_( "numpy" ).attr( "array" )( nb::cast( names ) );
}

nb::object reference( const PyChecker& checker )
{
	const NewArray<double> out( { checker.problem->reference.size() } );
	std::copy( checker.problem->reference.begin(), checker.problem->reference.end(), out.data );
	return out.object;
}

nb::object startState( const PyChecker& checker )
{
	const std::vector<double> state = io::startState( *checker.problem );
	const NewArray<double> out( { state.size() } );
	std::copy( state.begin(), state.end(), out.data );
	return out.object;
}

nb::object fullState( const PyChecker& checker, const Doubles& q )
{
	const Rows rows = rowsOf( q, checker.variables(), "q", "variables of the group" );
	const std::size_t width = lw_robot_variable_count( lw_checker_robot( checker.get() ) );
	const NewArray<double> out = rows.single ? NewArray<double>( { width } ) : NewArray<double>( { rows.count, width } );
	for ( std::size_t i = 0; i < rows.count; ++i )
	{
		lw_checker_full_state( checker.get(), rows[i], out.data + i * width );
	}
	return out.object;
}

nb::dict checkerInfo( const PyChecker& checker )
{
	const lw_checker_info info = lw_checker_get_info( checker.get() );
	nb::dict out;
	out["moving_bodies"] = info.moving_bodies;
	out["static_bodies"] = info.static_bodies;
	out["environment_pairs"] = info.environment_pairs;
	out["self_pairs"] = info.self_pairs;
	out["never_pairs"] = info.never_pairs;
	out["near_shapes"] = info.near_shapes;
	out["horizon"] = info.horizon;
	out["environment_margin"] = info.environment_margin;
	out["self_margin"] = info.self_margin;
	out["bytes"] = info.bytes;
	return out;
}

void prepareChecker( const PyChecker& checker, const Whole& given )
{
	const unsigned threads = given.threads();
	lw_diag diag{};
	lw_status status = LW_OK;
	{
		const nb::gil_scoped_release unlocked;
		status = prepare( checker.get(), threads, &diag );
	}
	require( status, diag );
}

std::string checkerRepr( const PyChecker& checker )
{
	const lw_checker_info info = lw_checker_get_info( checker.get() );
	const std::string group = checker.problem->group.empty() ? "all variables" : "group " + checker.problem->group;
	return "<leeway.Checker of " + std::string( lw_robot_name( lw_checker_robot( checker.get() ) ) ) + ": " + group + ", " +
	       std::to_string( checker.variables() ) + " variables, " + std::to_string( objectNames( checker ).size() ) +
	       " objects, " + std::to_string( info.environment_pairs ) + " + " + std::to_string( info.self_pairs ) + " pairs>";
}

/// A value of an absent variable is an error.
void requireVariables( const PyRobot& robot, const std::map<std::string, double>& values )
{
	std::set<std::string> names;
	for ( std::uint32_t i = 0; i < lw_robot_variable_count( robot.robot.get() ); ++i )
	{
		names.insert( io::variableName( robot.robot.get(), i ) );
	}
	for ( const auto& [name, value] : values )
	{
		if ( names.count( name ) == 0 )
		{
			const std::string text =
			    "reference: robot " + robot.model->name + " has no variable '" + name + "'; Robot.variables lists them";
			throw nb::value_error( text.c_str() );
		}
	}
}

std::vector<double> stateOf( const nb::object& state, const PyWorld& world )
{
	if ( state.is_none() )
	{
		return {};
	}
	const Doubles numbers = nb::cast<Doubles>( state );
	const std::size_t size = world.world->problem()->variables.size();
	const double* q = vectorOf( numbers, size, "state", "variables of the group" );
	return { q, q + size };
}

/// The checker after a change, which runs without the interpreter's lock.
template <typename Change> PyChecker changed( PyWorld& world, const Change& change )
{
	const nb::gil_scoped_release unlocked;
	change( *world.world );
	return world.checker();
}

using Names = std::vector<std::string>;

PyChecker moveObject( PyWorld& world, const std::string& name, const nb::object& pose )
{
	const lw_transform to = poseOrIdentity( pose, "pose" );
	return changed( world, [&]( io::World& w ) { w.move( name, to ); } );
}

PyChecker addObject( PyWorld& world, const std::string& name, const nb::object& shapes, const nb::object& pose )
{
	const std::vector<io::PlacedShape> placed = placedShapes( shapes );
	const lw_transform at = poseOrIdentity( pose, "pose" );
	return changed( world, [&]( io::World& w ) { w.add( name, placed, at ); } );
}

PyChecker seeCloud( PyWorld& world, const std::string& name, PyCloud& cloud )
{
	return changed( world,
	    [&]( io::World& w )
	    {
		    const std::lock_guard<std::mutex> lock( cloud.mutex );
		    w.see( name, cloud.cloud );
	    } );
}

PyChecker removeObject( PyWorld& world, const std::string& name )
{
	return changed( world, [&]( io::World& w ) { w.remove( name ); } );
}

PyChecker attachObject(
    PyWorld& world, const std::string& name, const std::string& link, const Names& touch, const nb::object& state )
{
	const std::vector<double> q = stateOf( state, world );
	return changed( world, [&]( io::World& w ) { w.attach( name, link, touch, q ); } );
}

PyChecker attachObjectAt(
    PyWorld& world, const std::string& name, const std::string& link, const nb::object& pose, const Names& touch )
{
	const lw_transform at = poseOrIdentity( pose, "pose" );
	return changed( world, [&]( io::World& w ) { w.attachAt( name, link, touch, at ); } );
}

PyChecker detachObject( PyWorld& world, const std::string& name, const nb::object& state )
{
	const std::vector<double> q = stateOf( state, world );
	return changed( world, [&]( io::World& w ) { w.detach( name, q ); } );
}

PyChecker allowContact( PyWorld& world, const std::string& link, const std::string& object, bool allowed )
{
	return changed( world, [&]( io::World& w ) { w.allow( link, object, allowed ); } );
}

PyChecker setMargins( PyWorld& world, const io::Margins& margins )
{
	return changed( world, [&]( io::World& w ) { w.setMargins( margins ); } );
}

void bindWorldEdits( nb::class_<PyWorld>& type )
{
	type.def( "move", &moveObject, "name"_a, "pose"_a.none(),
	    nb::sig( "def move(self, name: str, pose: numpy.typing.ArrayLike | None) -> Checker" ),
	    "Gives an object another pose in the world." );
	type.def( "add", &addObject, "name"_a, "shapes"_a, "pose"_a = nb::none(),
	    nb::sig( "def add(self, name: str, shapes: Shape | Sequence[Shape | tuple[Shape, numpy.typing.ArrayLike]], "
	             "pose: numpy.typing.ArrayLike | None = None) -> Checker" ),
	    "Adds an object: a Shape, or a list of Shape and (Shape, pose in the object), at a pose in the world." );
	type.def( "see", &seeCloud, "name"_a, "cloud"_a,
	    "A live cloud as it is now becomes the object of this name, or replaces what it was at the call before." );
	type.def( "remove", &removeObject, "name"_a, "Removes an object; an attached one is detached first." );
	type.def( "attach", &attachObject, "name"_a, "link"_a, "touch_links"_a = Names(), "state"_a = nb::none(),
	    nb::sig( "def attach(self, name: str, link: str, touch_links: Sequence[str] = [], "
	             "state: numpy.typing.ArrayLike | None = None) -> Checker" ),
	    "Attaches an object to a link at the pose that it has in this state of the group (None: the reference). It may touch the link\n"
	    "and the touch links." );
	type.def( "attach_at", &attachObjectAt, "name"_a, "link"_a, "pose"_a.none(), "touch_links"_a = Names(),
	    nb::sig(
	        "def attach_at(self, name: str, link: str, pose: numpy.typing.ArrayLike | None, touch_links: Sequence[str] = []) -> "
	        "Checker" ),
	    "Attaches an object at a pose in the link's frame." );
	type.def( "detach", &detachObject, "name"_a, "state"_a = nb::none(),
	    nb::sig( "def detach(self, name: str, state: numpy.typing.ArrayLike | None = None) -> Checker" ),
	    "Detaches an object; it stays at the pose that it has in this state of the group (None: the reference)." );
	type.def( "allow", &allowContact, "link"_a, "object"_a, "allowed"_a = true,
	    "Allows or forbids contact of a link, or an attached object, with an object." );
	type.def( "set_margins", &setMargins, "margins"_a, "Replaces all margins except padding." );
}

template <typename Class, typename Make> void bindMaker( Class& type, Make make, const char* doc )
{
	type.def( "__init__", make, "robot"_a, "scene"_a.none() = nb::none(), nb::kw_only(), "group"_a = "",
	    "reference"_a = nb::none(), "allowed"_a = Allowed(), "margins"_a = nb::none(), "padding"_a = nb::none(),
	    "reach"_a.none() = nb::none(), "min_d"_a = 0.0, "max_d"_a = infinity,
	    nb::sig(
	        "def __init__(self, robot: Robot, scene: Scene | None = None, *, group: str = '', "
	        "reference: Mapping[str, float] | None = None, allowed: Sequence[tuple[str, str]] = [], "
	        "margins: Margins | None = None, padding: Padding | None = None, reach: Reach | None = None, min_d: float = 0.0, "
	        "max_d: float = float('inf')) -> None" ),
	    doc );
}

void bindProperties( nb::class_<PyChecker>& type )
{
	type.def_prop_ro( "dof", &PyChecker::variables, "Number of variables of a state." );
	type.def_prop_ro(
	    "group", []( const PyChecker& c ) { return c.problem->group; }, "Name of the group; empty = all variables." );
	type.def_prop_ro(
	    "variables", []( const PyChecker& c ) { return c.problem->variable_names; }, "Names of a state's variables." );
	type.def_prop_ro(
	    "lower", []( const PyChecker& c ) { return limits( c, false ); },
	    nb::sig( "def lower(self) -> numpy.typing.NDArray[numpy.float64]" ),
	    "float64 [dof]: lower limits; -pi for endless joints." );
	type.def_prop_ro(
	    "upper", []( const PyChecker& c ) { return limits( c, true ); },
	    nb::sig( "def upper(self) -> numpy.typing.NDArray[numpy.float64]" ),
	    "float64 [dof]: upper limits; pi for endless joints." );
	type.def_prop_ro( "wraps", &wraps, nb::sig( "def wraps(self) -> numpy.typing.NDArray[numpy.bool_]" ),
	    "bool [dof]: endless joints, whose values wrap." );
	type.def_prop_ro( "links", &linkNames, "Names of the robot's links, attached objects included." );
	type.def_prop_ro( "objects", &objectNames, "Names of the scene's objects." );
	type.def_prop_ro( "names", &pairNames, nb::sig( "def names(self) -> numpy.typing.NDArray[numpy.str_]" ),
	    "Names of links, then of objects, then \"\": names[pairs] are the names of the pairs of a result." );
	type.def_prop_ro( "reference", &reference, nb::sig( "def reference(self) -> numpy.typing.NDArray[numpy.float64]" ),
	    "float64 [robot variables]: values of the variables outside of the group." );
	type.def_prop_ro( "start", &startState, nb::sig( "def start(self) -> numpy.typing.NDArray[numpy.float64]" ),
	    "float64 [dof]: the group's variables in the scene's robot state." );
	type.def_prop_ro(
	    "notices", []( const PyChecker& c ) { return noticeLines( c.problem->notices ); },
	    "Lines on input that was changed, assumed or ignored." );
	type.def_prop_ro(
	    "info", &checkerInfo, nb::sig( "def info(self) -> dict[str, float]" ), "Counts of bodies and pairs, and memory." );
}

} // namespace

PyChecker::PyChecker( std::shared_ptr<const io::Problem> made, std::shared_ptr<const io::RobotModel> robot )
    : problem( std::move( made ) ), model( std::move( robot ) ), queries( std::make_shared<QueryPool>( problem->checker ) ),
      certifier( newCertifier( problem, model ) )
{
}

Query QueryPool::take()
{
	{
		const std::lock_guard<std::mutex> lock( m_mutex );
		if ( !m_free.empty() )
		{
			Query query = std::move( m_free.back() );
			m_free.pop_back();
			return query;
		}
	}
	return makeQuery( m_checker.get() );
}

void QueryPool::giveBack( Query query )
{
	lw_query_reset( query.get() ); // it keeps no checker alive
	const std::lock_guard<std::mutex> lock( m_mutex );
	m_free.push_back( std::move( query ) );
}

void refusePickle( const nb::object& )
{
	throw nb::type_error( "a Checker, World or Reach is not pickled: pickle the Robot and the Scene, and make it of these "
	                      "once in each process, such as leeway.Checker(robot, scene, group=...)" );
}

io::ProblemOptions optionsOf( const PyRobot& robot, const io::SceneModel* scene, const ProblemArguments& arguments )
{
	io::ProblemOptions options;
	options.group = arguments.group;
	options.scene = scene;
	if ( !arguments.reference.is_none() )
	{
		options.overrides.values = nb::cast<std::map<std::string, double>>( arguments.reference );
		requireVariables( robot, options.overrides.values );
	}
	options.allowed = arguments.allowed;
	if ( !arguments.margins.is_none() )
	{
		options.margins = nb::cast<io::Margins>( arguments.margins );
	}
	if ( !arguments.padding.is_none() )
	{
		options.padding = nb::cast<io::Padding>( arguments.padding );
	}
	if ( arguments.reach != nullptr )
	{
		options.reach = arguments.reach->loaded.reach;
	}
	options.min_d = arguments.min_d;
	options.max_d = arguments.max_d;
	return options;
}

lw_check_flags checkFlags( const std::string& name )
{
	if ( name != "both" && name != "environment" && name != "self" )
	{
		const std::string text = "check: '" + name + "' is none of 'both', 'environment', 'self'";
		throw nb::value_error( text.c_str() );
	}
	return name == "both" ? LW_CHECK_BOTH : name == "self" ? LW_CHECK_SELF : LW_CHECK_ENVIRONMENT;
}

void inBlocks( QueryPool& queries, std::size_t count, std::size_t block, unsigned threads,
    const std::function<void( lw_query*, std::size_t, std::size_t )>& work )
{
	using Clock = std::chrono::steady_clock;
	constexpr auto pause = std::chrono::milliseconds( 50 );
	const unsigned most = threads > 0 ? threads : std::max( 1U, std::thread::hardware_concurrency() );
	const std::thread::id caller = std::this_thread::get_id();
	Clock::time_point looked = Clock::now();
	const nb::gil_scoped_release unlocked;
	inParallel( ( count + block - 1 ) / block, most,
	    [&]( std::size_t i )
	    {
		    {
			    const Lease query( queries );
			    work( query.get(), i * block, std::min( count, ( i + 1 ) * block ) );
		    }
		    if ( std::this_thread::get_id() == caller && Clock::now() - looked > pause )
		    {
			    const nb::gil_scoped_acquire locked;
			    if ( PyErr_CheckSignals() != 0 ) // Ctrl-C ends the batch
			    {
				    throw nb::python_error();
			    }
			    looked = Clock::now();
		    }
	    } );
}

nb::object result( const char* type, const nb::tuple& values )
{
	return nb::module_::import_( "leeway.results" ).attr( type )( *values );
}

void bindCheckers( nb::module_& module )
{
	nb::class_<PyChecker> type( module, "Checker",
	    "A group of a robot in a scene: a snapshot that any number of threads may use. All numbers are clearances (distance minus\n"
	    "margin) in metres; lower <= clearance <= upper. An error raises and never reads as free." );
	bindMaker( type, &makeChecker,
	    "group: name in the SRDF, empty = all variables. reference: values of other variables by name. allowed: pairs of names that may\n"
	    "touch. margins, padding: metres. reach: motion hulls and pair tables, which make checks faster and change no answer. min_d: only\n"
	    "for notices. max_d: metres, the largest clearance of interest; it changes no answer.\nRaises InputError." );
	bindProperties( type );
	bindStates( type );
	bindNear( type );
	bindMotions( type );
	bindAudits( module, type );
	bindReferee( type );
	bindCertificates( type );
	bindGoals( type );
	bindPlans( module, type );
	type.def( "full_state", &fullState, "q"_a,
	    nb::sig( "def full_state(self, q: numpy.typing.ArrayLike) -> numpy.typing.NDArray[numpy.float64]" ),
	    "States of the whole robot for states of the group: float64 [n, dof] to [n, robot variables]." );
	type.def( "prepare", &prepareChecker, "threads"_a.none() = 0, nb::sig( "def prepare(self, threads: int = 0) -> None" ),
	    "Builds the sphere trees that states within the limits can need, so that no later call has to. threads: 0 = one per core." );
	type.def( "__repr__", &checkerRepr );
	type.def( "__reduce__", &refusePickle );

	nb::class_<PyWorld> world( module, "World",
	    "A robot in a scene that changes. Each change returns a new Checker; those before stay valid. Poses are those of object frames." );
	bindMaker( world, &makeWorld, "Arguments as for Checker." );
	world.def_prop_ro( "checker", &PyWorld::checker, "The checker of the world as it is now." );
	bindWorldEdits( world );
	world.def( "__reduce__", &refusePickle );
	world.def( "__repr__", []( const PyWorld& w ) { return "<leeway.World now " + checkerRepr( w.checker() ) + ">"; } );
}

} // namespace leeway::python
