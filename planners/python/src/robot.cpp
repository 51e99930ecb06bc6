// SPDX-License-Identifier: BSD-3-Clause
// leeway.Robot: a URDF with its SRDF, forward kinematics, enclosing spheres.
#include "objects.hpp"

#include "leeway/io/spheres.hpp"
#include "tools/process.hpp"
#include "tools/xacro.hpp"

#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <cstdio>
#include <filesystem>
#include <limits>

namespace leeway::python
{

namespace
{

using namespace nb::literals;

/// Text that is read like a file, under its own name in messages.
class TextFiles
{
public:
	std::string add( const std::string& name, const std::string& text ) const { return m_folder.write( name, text ); }
	/// The name without the folder, for messages.
	std::string shown( const std::string& file ) const
	{
		const std::string folder = m_folder.path() + "/";
		return file.rfind( folder, 0 ) == 0 ? file.substr( folder.size() ) : file;
	}

private:
	tools::TemporaryFolder m_folder;
};

bool isText( const std::string& given )
{
	return given.find( '<' ) != std::string::npos;
}

/// The interpreter that runs this, which may have xacro where $PATH has none.
tools::XacroSettings xacroSettings( const nb::dict& arguments, const std::vector<std::string>& packages )
{
	tools::XacroSettings settings;
	for ( const auto& [name, value] : arguments )
	{
		settings.arguments.push_back( std::string( nb::str( name ).c_str() ) + ":=" + nb::str( value ).c_str() );
	}
	settings.package_paths = packages;
	const nb::object interpreter = nb::module_::import_( "sys" ).attr( "executable" );
	settings.python = nb::isinstance<nb::str>( interpreter ) ? nb::cast<std::string>( interpreter ) : settings.python;
	return settings;
}

io::LoadOptions loadOptions( const std::vector<std::string>& packages, double detail, bool visual, bool strict,
    const std::vector<std::string>& solid, const std::string& cache )
{
	io::LoadOptions options;
	options.package_paths = packages;
	options.detail = detail;
	options.use_visual = visual;
	options.strict = strict;
	options.solid = solid;
	options.cache = cache;
	return options;
}

/// @param urdf, srdf paths, or the text of the documents
io::RobotModel readRobot( const std::string& urdf, const std::string& srdf, const io::LoadOptions& options )
{
	if ( !isText( urdf ) && !isText( srdf ) )
	{
		return io::loadRobot( urdf, srdf, options );
	}
	const TextFiles files;
	const std::string urdf_file = isText( urdf ) ? files.add( "URDF text", urdf ) : urdf;
	const std::string srdf_file = isText( srdf ) ? files.add( "SRDF text", srdf ) : srdf;
	try
	{
		io::RobotModel model = io::loadRobot( urdf_file, srdf_file, options );
		model.urdf_file = files.shown( urdf_file );
		model.srdf_file = files.shown( srdf_file );
		for ( io::Notice& notice : model.report.notices )
		{
			notice.file = files.shown( notice.file );
		}
		return model;
	}
	catch ( const io::Error& error )
	{
		throw io::Error( files.shown( error.file() ), error.element(), error.problem(), error.remedy() );
	}
}

void makeRobot( PyRobot* self, const std::filesystem::path& urdf, const std::filesystem::path& srdf,
    const std::vector<std::string>& packages, double detail, bool visual, bool strict, const std::vector<std::string>& solid,
    const std::string& cache, const std::optional<nb::dict>& xacro, const std::string& missing_meshes )
{
	io::LoadOptions options = loadOptions( packages, detail, visual, strict, solid, cache );
	if ( missing_meshes != "refuse" && missing_meshes != "skip" )
	{
		throw nb::value_error( ( "missing_meshes is '" + missing_meshes + "'; give 'refuse' or 'skip'" ).c_str() );
	}
	options.skip_missing_meshes = missing_meshes == "skip";
	if ( xacro )
	{
		options.expand_xacro = [settings = xacroSettings( *xacro, packages )]( const std::string& file )
		{ return tools::expandXacro( file, settings ); };
	}
	else
	{
		options.expand_xacro = []( const std::string& file ) -> io::ExpandedRobot
		{
			throw io::Error( file, "<robot>", "this is a xacro file",
			    "add xacro={}, with its arguments: the program xacro expands it then, and executes code of the file; or run xacro first: "
			    "xacro " +
			        file + " > robot.urdf" );
		};
	}
	const nb::gil_scoped_release unlocked;
	io::RobotModel model = readRobot( urdf.string(), srdf.string(), options );
	if ( xacro && model.expanded_urdf.empty() )
	{
		throw io::Error( urdf.string(), "xacro", "is no xacro file", "leave xacro out" );
	}
	new ( self ) PyRobot( std::move( model ) );
}

std::vector<std::string> linkNames( const PyRobot& robot )
{
	std::vector<std::string> names;
	for ( std::uint32_t i = 0; i < lw_robot_link_count( robot.robot.get() ); ++i )
	{
		names.emplace_back( lw_robot_link_name( robot.robot.get(), i ) );
	}
	return names;
}

std::vector<std::string> variableNames( const PyRobot& robot )
{
	std::vector<std::string> names;
	for ( std::uint32_t i = 0; i < lw_robot_variable_count( robot.robot.get() ); ++i )
	{
		names.push_back( io::variableName( robot.robot.get(), i ) );
	}
	return names;
}

nb::object limits( const PyRobot& robot, bool upper )
{
	const std::uint32_t count = lw_robot_variable_count( robot.robot.get() );
	const NewArray<double> out( { count } );
	for ( std::uint32_t i = 0; i < count; ++i )
	{
		const lw_variable_info info = lw_robot_variable( robot.robot.get(), i );
		out.data[i] = upper ? info.upper : info.lower;
	}
	return out.object;
}

nb::object defaultState( const PyRobot& robot )
{
	const NewArray<double> out( { lw_robot_variable_count( robot.robot.get() ) } );
	lw_robot_default_state( robot.robot.get(), out.data );
	return out.object;
}

nb::object forwardKinematics( const PyRobot& robot, const Doubles& q )
{
	const lw_robot* core = robot.robot.get();
	const Rows rows = rowsOf( q, lw_robot_variable_count( core ), "q", "variables of the robot" );
	const std::size_t links = lw_robot_link_count( core );
	const NewArray<double> out =
	    rows.single ? NewArray<double>( { links, 4, 4 } ) : NewArray<double>( { rows.count, links, 4, 4 } );
	std::size_t failed = rows.count;
	{
		const nb::gil_scoped_release unlocked;
		std::vector<lw_transform> poses( links );
		for ( std::size_t i = 0; i < rows.count && failed == rows.count; ++i )
		{
			failed = lw_robot_fk( core, rows[i], poses.data() ) == LW_OK ? rows.count : i;
			for ( std::size_t k = 0; k < links; ++k )
			{
				writePose( poses[k], out.data + ( i * links + k ) * 16 );
			}
		}
	}
	if ( failed < rows.count )
	{
		throw CoreError( LW_ERROR_INVALID_ARGUMENT,
		    "q[" + std::to_string( failed ) + "]: a number is not finite, or a quaternion is zero; correct the state" );
	}
	return out.object;
}

nb::object interpolate( const PyRobot& robot, const Doubles& a, const Doubles& b, const Doubles& t )
{
	const lw_robot* core = robot.robot.get();
	const std::size_t width = lw_robot_variable_count( core );
	const double* qa = vectorOf( a, width, "a", "variables of the robot" );
	const double* qb = vectorOf( b, width, "b", "variables of the robot" );
	const NewArray<double> out =
	    t.dimensions() == 0 ? NewArray<double>( { width } ) : NewArray<double>( { t.size(), width } );
	for ( std::size_t i = 0; i < t.size(); ++i )
	{
		lw_robot_interpolate( core, qa, qb, t.data()[i], out.data + i * width );
	}
	return out.object;
}

std::map<std::string, std::vector<std::string>> groups( const PyRobot& robot )
{
	std::map<std::string, std::vector<std::string>> out;
	for ( const io::Group& group : robot.model->groups )
	{
		out[group.name] = group.joints;
	}
	return out;
}

nb::dict groupStates( const PyRobot& robot )
{
	nb::dict out;
	for ( const io::GroupState& state : robot.model->group_states )
	{
		out[nb::make_tuple( state.group, state.name )] = nb::cast( state.joints );
	}
	return out;
}

std::vector<std::pair<std::string, std::string>> disabledPairs( const PyRobot& robot )
{
	std::vector<std::pair<std::string, std::string>> out;
	for ( const io::DisabledPair& pair : robot.model->disabled )
	{
		out.emplace_back( pair.link1, pair.link2 );
	}
	return out;
}

std::map<std::string, double> velocityLimits( const PyRobot& robot )
{
	std::map<std::string, double> out;
	for ( const io::JointModel& joint : robot.model->joints )
	{
		if ( joint.velocity > 0 )
		{
			out[joint.name] = joint.velocity;
		}
	}
	return out;
}

nb::dict collision( const PyRobot& robot )
{
	nb::dict out;
	for ( const io::LinkModel& link : robot.model->links )
	{
		nb::list placed;
		for ( const io::PlacedShape& shape : link.collision )
		{
			placed.append( nb::make_tuple( shape.shape, poseArray( shape.pose ) ) );
		}
		out[link.name.c_str()] = placed;
	}
	return out;
}

nb::dict spheres(
    const PyRobot& robot, double excess, const Whole& count, double close_holes, double seconds, const Whole& threads )
{
	io::SpherizeOptions options;
	options.excess = excess;
	options.sphere_count = static_cast<std::uint32_t>( count.in( "count", 0, std::numeric_limits<std::uint32_t>::max() ) );
	options.close_holes = close_holes;
	options.seconds = seconds;
	options.threads = threads.threads();
	std::vector<io::LinkSpheres> links;
	{
		const nb::gil_scoped_release unlocked;
		links = io::spherize( *robot.model, options );
	}
	nb::dict out;
	for ( const io::LinkSpheres& link : links )
	{
		const NewArray<double> array( { link.count(), 4 } );
		std::copy( link.spheres.begin(), link.spheres.end(), array.data );
		out[link.link.c_str()] =
		    result( "LinkSpheres", nb::make_tuple( array.object, link.report.excess, link.report.encloses ) );
	}
	return out;
}

std::string writeSrdf(
    const PyRobot& robot, const std::vector<std::pair<std::string, std::string>>& pairs, const std::string& reason )
{
	std::vector<io::DisabledPair> disabled;
	disabled.reserve( pairs.size() );
	for ( const auto& [a, b] : pairs )
	{
		disabled.push_back( { a, b, reason } );
	}
	return io::writeSrdf( *robot.model, disabled ).text;
}

/// The robot with more pairs of links that may touch.
PyRobot withAllowed( const PyRobot& robot, const std::vector<std::pair<std::string, std::string>>& pairs )
{
	io::RobotModel model = *robot.model;
	for ( const auto& [a, b] : pairs )
	{
		for ( const std::string& name : { a, b } )
		{
			if ( lw_robot_find_link( robot.robot.get(), name.c_str() ) == LW_INVALID_INDEX )
			{
				const std::string text =
				    "allowed(): robot " + model.name + " has no link '" + name + "'; Robot.links lists them";
				throw nb::value_error( text.c_str() );
			}
		}
		if ( a == b )
		{
			const std::string text = "allowed(): link '" + a + "' is paired with itself; give two links";
			throw nb::value_error( text.c_str() );
		}
		model.disabled.push_back( { a, b, "User" } );
	}
	const nb::gil_scoped_release unlocked;
	return PyRobot( std::move( model ) );
}

std::string robotRepr( const PyRobot& robot )
{
	std::uint64_t triangles = 0;
	std::size_t shapes = 0;
	for ( const io::LinkModel& link : robot.model->links )
	{
		for ( const io::PlacedShape& placed : link.collision )
		{
			triangles += lw_shape_peek_info( placed.shape.get() ).triangle_count;
			++shapes;
		}
	}
	return "<leeway.Robot " + robot.model->name + ": " + std::to_string( robot.model->links.size() ) + " links, " +
	       std::to_string( lw_robot_variable_count( robot.robot.get() ) ) + " variables, " + std::to_string( shapes ) +
	       " collision shapes, " + std::to_string( triangles ) + " triangles>";
}

void bindProperties( nb::class_<PyRobot>& type )
{
	type.def_prop_ro(
	    "name", []( const PyRobot& r ) { return r.model->name; }, "Name of the robot in its URDF." );
	type.def_prop_ro( "links", &linkNames, "Names of all links, in the order of fk()." );
	type.def_prop_ro( "variables", &variableNames,
	    "Names of all variables, in the order of a robot state; metres and radians. Fixed and mimic joints have none." );
	type.def_prop_ro(
	    "lower", []( const PyRobot& r ) { return limits( r, false ); },
	    nb::sig( "def lower(self) -> numpy.typing.NDArray[numpy.float64]" ),
	    "float64 [variables]: lower limits; -pi for endless joints." );
	type.def_prop_ro(
	    "upper", []( const PyRobot& r ) { return limits( r, true ); },
	    nb::sig( "def upper(self) -> numpy.typing.NDArray[numpy.float64]" ),
	    "float64 [variables]: upper limits; pi for endless joints." );
	type.def_prop_ro( "velocity_limits", &velocityLimits, "Limits of the URDF by joint, rad/s and m/s." );
	type.def_prop_ro(
	    "root_link", []( const PyRobot& r ) { return r.model->root_link; }, "Name of the root link." );
	type.def_prop_ro( "groups", &groups, "Joints of each group of the SRDF." );
	type.def_prop_ro( "group_states", &groupStates,
	    nb::sig( "def group_states(self) -> dict[tuple[str, str], dict[str, list[float]]]" ),
	    "Named states of the SRDF: (group, state) to values by joint." );
	type.def_prop_ro( "disabled_pairs", &disabledPairs, "Pairs of links that the SRDF allows to touch." );
	type.def_prop_ro(
	    "notices", []( const PyRobot& r ) { return noticeLines( r.model->report.notices ); },
	    "Lines on input that the reader changed, assumed or ignored." );
	type.def_prop_ro(
	    "digest", []( const PyRobot& robot ) { return digestText( lw_robot_digest( robot.robot.get() ) ); },
	    "32 hexadecimal digits: robots with equal answers have equal digests." );
	type.def_prop_ro( "collision", &collision,
	    nb::sig( "def collision(self) -> dict[str, list[tuple[Shape, numpy.typing.NDArray[numpy.float64]]]]" ),
	    "Collision shapes of each link, with their poses [4, 4] in the link's frame." );
}

void bindFunctions( nb::class_<PyRobot>& type )
{
	type.def( "default_state", &defaultState, nb::sig( "def default_state(self) -> numpy.typing.NDArray[numpy.float64]" ),
	    "float64 [variables]: 0, or the limit nearest to 0." );
	type.def( "fk", &forwardKinematics, "q"_a,
	    nb::sig( "def fk(self, q: numpy.typing.ArrayLike) -> numpy.typing.NDArray[numpy.float64]" ),
	    "Forward kinematics. q: float64 [n, variables] or [variables], radians and metres. Returns the poses of all links in the world:\n"
	    "float64 [n, links, 4, 4] or [links, 4, 4]." );
	type.def( "interpolate", &interpolate, "a"_a, "b"_a, "t"_a,
	    nb::sig( "def interpolate(self, a: numpy.typing.ArrayLike, b: numpy.typing.ArrayLike, t: numpy.typing.ArrayLike) -> "
	             "numpy.typing.NDArray[numpy.float64]" ),
	    "States at t in [0, 1] on the straight edge from robot state a to b: [variables] for a number t, [m, variables] for t [m].\n"
	    "Endless joints take the shorter way, quaternions slerp." );
	type.def( "spheres", &spheres, nb::kw_only(), "excess"_a = 0.0, "count"_a.none() = 0, "close_holes"_a = 0.0,
	    "seconds"_a = 0.0, "threads"_a.none() = 0,
	    nb::sig( "def spheres(self, *, excess: float = 0.0, count: int = 0, close_holes: float = 0.0, seconds: float = 0.0, "
	             "threads: int = 0) -> dict[str, leeway.results.LinkSpheres]" ),
	    "Few spheres around each link, proved to enclose it: (spheres float64 [n, 4], excess in metres, encloses) by link. Give the\n"
	    "excess in metres that a sphere may extend beyond its link, or the largest count of the whole robot." );
	type.def( "allowed", &withAllowed, "pairs"_a,
	    "A robot in which these pairs of links may touch too. pairs: [(link, link), ...]. This one stays as it is." );
	type.def( "srdf", &writeSrdf, "pairs"_a, "reason"_a = "Never",
	    "Text of the SRDF with its computed disabled pairs replaced by `pairs`; decisions of its author stay." );
	type.def( "__repr__", &robotRepr );
	type.def( "__getstate__", &robotState );
	type.def( "__setstate__",
	    []( PyRobot& robot, const nb::tuple& state ) { new ( &robot ) PyRobot( robotFromState( state ) ); } );
}

} // namespace

PyRobot::PyRobot( io::RobotModel read )
    : model( std::make_shared<const io::RobotModel>( std::move( read ) ) ), robot( io::buildRobot( *model ) )
{
}

std::vector<std::string> noticeLines( const std::vector<io::Notice>& notices )
{
	std::vector<std::string> lines;
	lines.reserve( notices.size() );
	for ( const io::Notice& notice : notices )
	{
		lines.push_back( ( notice.file.empty() ? "" : notice.file + ": " ) + notice.element + ": " + notice.text );
	}
	return lines;
}

void bindRobots( nb::module_& module )
{
	nb::class_<PyRobot> type( module, "Robot",
	    "A robot: links with collision shapes, joints, groups. Immutable; threads may share it; pickle keeps its shapes." );
	type.def( "__init__", &makeRobot, "urdf"_a, "srdf"_a = "", nb::kw_only(), "packages"_a = std::vector<std::string>(),
	    "detail"_a = 0.0, "visual"_a = false, "strict"_a = false, "solid"_a = std::vector<std::string>(), "cache"_a = "",
	    "xacro"_a.none() = nb::none(), "missing_meshes"_a = "refuse",
	    "Reads a URDF and an SRDF: paths, or the text of the documents (anything with a '<').\n\n"
	    "packages: folders for package:// URIs, or \"name=folder\". detail: metres, coarser shapes that contain the original may\n"
	    "replace meshes. visual: a link without collision geometry uses its visual geometry. strict: an SRDF that names absent\n"
	    "links is an error. solid: links whose meshes are closed and solid, \"*\" = all. cache: a folder that keeps sphere trees.\n"
	    "xacro: a dict of arguments, {} for none: the file is expanded by the program xacro, which executes code of the file and of those\n"
	    "that it includes. Without it a xacro file is refused. missing_meshes: \"skip\" leaves meshes that are nowhere out, so that nothing\n"
	    "collides with them; notices name them.\n"
	    "Raises InputError, which names file, element and remedy." );
	bindProperties( type );
	bindFunctions( type );
}

} // namespace leeway::python
