// SPDX-License-Identifier: BSD-3-Clause
// leeway.Cloud: live clouds from NumPy arrays, and worlds that see them.
#include "objects.hpp"

#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>

#include <cmath>
#include <filesystem>
#include <limits>

namespace leeway::python
{

namespace
{

using namespace nb::literals;

/// Any array of NumPy's, with its strides.
using AnyArray = nb::ndarray<nb::ro, nb::device::cpu>;

[[noreturn]] void refuse( const std::string& text )
{
	throw nb::value_error( text.c_str() );
}

template <typename T> bool holds( const AnyArray& array )
{
	return array.dtype() == nb::dtype<T>();
}

/// Arguments that all frames have.
struct FrameArguments
{
	double stamp;
	nb::object pose;
	Whole sensor;
	double near, far;
	bool trust_far, clears;
	const PyChecker* checker;
	nb::object state;
};

/// A frame without points, and the state that it points to.
struct Frame
{
	explicit Frame( const FrameArguments& arguments ) : frame( lw_cloud_frame_default() )
	{
		frame.stamp = arguments.stamp;
		frame.world_from_sensor = poseOrIdentity( arguments.pose, "pose" );
		frame.sensor = static_cast<std::uint32_t>( arguments.sensor.in( "sensor", 0, LW_CLOUD_SENSORS - 1 ) );
		frame.near = arguments.near;
		frame.far = arguments.far;
		frame.trust_far = arguments.trust_far;
		frame.clears = arguments.clears;
		if ( arguments.checker == nullptr )
		{
			return;
		}
		const lw_robot* robot = lw_checker_robot( arguments.checker->get() );
		full.resize( lw_robot_variable_count( robot ) );
		if ( arguments.state.is_none() )
		{
			refuse( "state: give the robot's state at the stamp, of the checker's group" );
		}
		const Doubles q = nb::cast<Doubles>( arguments.state );
		lw_checker_full_state( arguments.checker->get(),
		    vectorOf( q, arguments.checker->variables(), "state", "variables of the group" ), full.data() );
		frame.robot = robot;
		frame.state = full.data();
	}
	lw_cloud_frame frame;
	std::vector<double> full;
};

nb::dict insert( PyCloud& cloud, const Frame& frame )
{
	lw_cloud_report report;
	{
		const nb::gil_scoped_release unlocked;
		const std::lock_guard<std::mutex> lock( cloud.mutex );
		report = cloud.cloud.insert( frame.frame );
	}
	nb::dict out;
	out["inserted"] = report.inserted;
	out["not_measured"] = report.not_measured;
	out["out_of_range"] = report.out_of_range;
	out["outside"] = report.outside;
	out["own"] = report.own;
	out["added"] = report.added;
	out["cleared"] = report.cleared;
	out["uncovered"] = report.uncovered;
	return out;
}

/// Bytes from one entry to the next along an axis. @throws nb::value_error for an array that runs backwards
std::size_t step( const AnyArray& array, std::size_t axis, const char* name )
{
	if ( array.stride( axis ) < 0 )
	{
		refuse( std::string( name ) + ": the array runs backwards; give numpy.ascontiguousarray() of it" );
	}
	return static_cast<std::size_t>( array.stride( axis ) ) * array.itemsize();
}

nb::dict insertPoints( PyCloud& cloud, const AnyArray& points, double stamp, const nb::object& pose, const Whole& sensor,
    double near, double far, bool trust_far, bool clears, bool in_world, const PyChecker* checker, const nb::object& state )
{
	const std::size_t dimensions = points.ndim();
	if ( ( dimensions != 2 && dimensions != 3 ) || points.shape( dimensions - 1 ) != 3 ||
	     !( holds<float>( points ) || holds<double>( points ) ) )
	{
		refuse( "points: give float32 or float64 of shape [n, 3] or [rows, columns, 3]" );
	}
	Frame frame( { stamp, pose, sensor, near, far, trust_far, clears, checker, state } );
	const std::size_t width = points.shape( dimensions - 2 ), height = dimensions == 3 ? points.shape( 0 ) : 1;
	if ( width > UINT32_MAX || height > UINT32_MAX )
	{
		refuse( "points: there are too many" );
	}
	lw_cloud_points& out = frame.frame.points;
	static const double nothing[3] = { 0, 0, 0 };
	out.data = points.size() > 0 ? points.data() : nothing;
	out.width = static_cast<std::uint32_t>( points.size() > 0 ? width : 0 );
	out.height = static_cast<std::uint32_t>( height );
	const std::size_t number = step( points, dimensions - 1, "points" );
	for ( std::size_t k = 0; k < 3; ++k )
	{
		out.offset[k] = k * number;
	}
	out.is_double = holds<double>( points );
	// of one point no step is used
	out.point_step = width > 1 ? step( points, dimensions - 2, "points" ) : 3 * points.itemsize() + 2 * number;
	if ( out.point_step < 2 * number + points.itemsize() )
	{
		refuse( "points: the array is not stored point by point; give numpy.ascontiguousarray() of it" );
	}
	out.row_step = dimensions == 3 ? step( points, 0, "points" ) : 0;
	out.in_world = in_world;
	return insert( cloud, frame );
}

nb::dict insertDepth( PyCloud& cloud, const AnyArray& depth, const nb::object& intrinsics, double stamp,
    const nb::object& pose, const nb::object& scale, const Whole& sensor, double near, double far, bool trust_far,
    bool clears, const PyChecker* checker, const nb::object& state )
{
	const bool is_float = holds<float>( depth );
	if ( depth.ndim() != 2 || !( is_float || holds<std::uint16_t>( depth ) ) ||
	     ( depth.shape( 1 ) > 1 && depth.stride( 1 ) != 1 ) )
	{
		refuse(
		    "depth: give uint16 (millimetres) or float32 (metres) of shape [height, width], pixels of a row beside each other" );
	}
	Frame frame( { stamp, pose, sensor, near, far, trust_far, clears, checker, state } );
	const Doubles lens = nb::cast<Doubles>( intrinsics );
	const bool is_matrix = lens.dimensions() == 2 && lens.size() == 9;
	const double* k = is_matrix ? lens.data() : vectorOf( lens, 4, "intrinsics", "numbers fx, fy, cx, cy" );
	lw_cloud_depth& out = frame.frame.depth;
	static const float nothing = 0;
	out.data = depth.size() > 0 ? depth.data() : &nothing;
	out.width = static_cast<std::uint32_t>( depth.size() > 0 ? std::min<std::size_t>( depth.shape( 1 ), UINT32_MAX ) : 0 );
	out.height = static_cast<std::uint32_t>( depth.size() > 0 ? std::min<std::size_t>( depth.shape( 0 ), UINT32_MAX ) : 0 );
	out.row_step = out.height > 1 ? step( depth, 0, "depth" ) : out.width * depth.itemsize();
	out.is_float = is_float;
	out.scale = scale.is_none() ? ( is_float ? 1 : 0.001 ) : nb::cast<double>( scale );
	out.fx = k[0];
	out.fy = k[is_matrix ? 4 : 1];
	out.cx = k[2];
	out.cy = k[is_matrix ? 5 : 3];
	return insert( cloud, frame );
}

nb::dict insertMessage( PyCloud& cloud, const nb::bytes& data,
    const std::map<std::string, std::pair<unsigned, unsigned>>& fields, const Whole& width, const Whole& point_step,
    double stamp, const nb::object& pose, const Whole& height, const nb::object& row_step, bool is_bigendian,
    const Whole& sensor, double near, double far, bool trust_far, bool clears, const PyChecker* checker,
    const nb::object& state )
{
	Frame frame( { stamp, pose, sensor, near, far, trust_far, clears, checker, state } );
	io::PointCloudMessage message;
	message.width = static_cast<std::uint32_t>( width.in( "width", 0, UINT32_MAX ) );
	message.height = static_cast<std::uint32_t>( height.in( "height", 0, UINT32_MAX ) );
	message.point_step = static_cast<std::uint32_t>( point_step.in( "point_step", 1, UINT32_MAX ) );
	message.row_step = static_cast<std::uint32_t>( row_step.is_none() ? std::uint64_t{ message.width } * message.point_step
	                                                                  : Whole{ row_step }.in( "row_step", 0, UINT32_MAX ) );
	message.is_bigendian = is_bigendian;
	for ( const auto& [name, place] : fields )
	{
		message.fields.push_back( { name, place.first, static_cast<std::uint8_t>( place.second ), 1 } );
	}
	message.data = static_cast<const std::uint8_t*>( data.data() );
	message.size = data.size();
	frame.frame.points = io::pointsOf( message );
	return insert( cloud, frame );
}

lw_cloud_voxel stateOfName( const std::string& name )
{
	if ( name != "occupied" && name != "free" && name != "unseen" )
	{
		refuse( "state: \"" + name + "\" is none of occupied, free, unseen" );
	}
	return name == "occupied" ? LW_VOXEL_OCCUPIED : name == "free" ? LW_VOXEL_FREE : LW_VOXEL_UNSEEN;
}

void makeCloud( PyCloud* self, double resolution, const nb::object& box, const std::string& unseen, double sensor_error,
    const nb::object& clear_margin, double shadow, double jump_distance, double jump_angle, const Whole& most_blocks,
    const Whole& threads )
{
	lw_cloud_def def = lw_cloud_def_default();
	def.resolution = resolution;
	if ( !box.is_none() )
	{
		const Doubles corners = nb::cast<Doubles>( box );
		if ( corners.dimensions() != 2 || corners.size() != 6 || corners.shape( 0 ) != 2 )
		{
			refuse( "box: give its least and greatest corner, [2, 3], not " + shapeText( corners ) );
		}
		std::copy( corners.data(), corners.data() + 3, def.box_min );
		std::copy( corners.data() + 3, corners.data() + 6, def.box_max );
	}
	if ( unseen != "free" && unseen != "blocked" )
	{
		refuse( "unseen: \"" + unseen + "\" is none of free, blocked" );
	}
	def.unseen_blocked = unseen == "blocked";
	def.sensor_error = sensor_error;
	def.clear_margin = clear_margin.is_none() ? NAN : nb::cast<double>( clear_margin );
	def.shadow = shadow;
	def.jump_distance = jump_distance;
	def.jump_angle = jump_angle;
	def.most_blocks = static_cast<std::uint32_t>( most_blocks.in( "most_blocks", 1, UINT32_MAX - 2 ) );
	new ( self ) PyCloud( def, threads.threads() );
}

/// Calls a function of the cloud alone with it, without the interpreter's lock.
template <typename Call> auto alone( PyCloud& cloud, const Call& call )
{
	const nb::gil_scoped_release unlocked;
	const std::lock_guard<std::mutex> lock( cloud.mutex );
	return call( cloud.cloud );
}

nb::dict cloudInfo( PyCloud& cloud )
{
	const lw_cloud_info info = alone( cloud, []( io::Cloud& c ) { return lw_cloud_get_info( c.get() ); } );
	nb::dict out;
	out["resolution"] = info.resolution;
	out["excess"] = info.excess;
	out["complete"] = info.complete;
	out["occupied"] = info.occupied;
	out["last_stamp"] = info.last_stamp;
	out["frames"] = info.frames;
	out["late"] = info.late;
	out["jumped"] = info.jumped;
	out["lost"] = info.lost;
	out["blocks"] = info.blocks;
	out["most_blocks"] = info.most_blocks;
	out["shapes"] = info.shapes;
	out["rebuilt"] = info.rebuilt;
	out["bytes"] = info.bytes;
	return out;
}

nb::object voxels( PyCloud& cloud, const std::string& state )
{
	const lw_cloud_voxel wanted = stateOfName( state );
	if ( wanted == LW_VOXEL_UNSEEN )
	{
		refuse( "state: unseen voxels are not listed; give occupied or free" );
	}
	const std::vector<double> centers = alone( cloud,
	    [&]( io::Cloud& c )
	    {
		    std::vector<double> found( 3 * lw_cloud_voxels( c.get(), wanted, nullptr, 0 ) );
		    lw_cloud_voxels( c.get(), wanted, found.data(), found.size() / 3 );
		    return found;
	    } );
	const NewArray<double> out( { centers.size() / 3, 3 } );
	std::copy( centers.begin(), centers.end(), out.data );
	return out.object;
}

nb::object states( PyCloud& cloud, const Doubles& points )
{
	const Rows rows = rowsOf( points, 3, "points", "coordinates" );
	const NewArray<std::uint8_t> out( { rows.count } );
	alone( cloud,
	    [&]( io::Cloud& c )
	    {
		    for ( std::size_t i = 0; i < rows.count; ++i )
		    {
			    out.data[i] = static_cast<std::uint8_t>( lw_cloud_state( c.get(), { rows[i][0], rows[i][1], rows[i][2] } ) );
		    }
	    } );
	return out.object;
}

void setBox( PyCloud& cloud, const Doubles& low, const Doubles& high, const std::string& state )
{
	const double* from = vectorOf( low, 3, "low", "coordinates" );
	const double* to = vectorOf( high, 3, "high", "coordinates" );
	const lw_cloud_voxel wanted = stateOfName( state );
	lw_diag diag{};
	const lw_status status =
	    alone( cloud, [&]( io::Cloud& c ) { return lw_cloud_set_box( c.get(), from, to, wanted, &diag ); } );
	require( status, diag );
}

void bindFrames( nb::class_<PyCloud>& type )
{
	const double infinity = std::numeric_limits<double>::infinity();
	type.def( "insert_points", &insertPoints, "points"_a, "stamp"_a, nb::kw_only(), "pose"_a = nb::none(), "sensor"_a = 0,
	    "near"_a = 0.0, "far"_a = infinity, "trust_far"_a = false, "clears"_a = true, "in_world"_a = false,
	    "robot"_a.none() = nb::none(), "state"_a = nb::none(),
	    nb::sig(
	        "def insert_points(self, points: numpy.typing.NDArray[typing.Any], stamp: float, *, "
	        "pose: numpy.typing.ArrayLike | None = None, sensor: int = 0, near: float = 0.0, far: float = float('inf'), "
	        "trust_far: bool = False, clears: bool = True, in_world: bool = False, robot: Checker | None = None, "
	        "state: numpy.typing.ArrayLike | None = None) -> dict[str, int]" ),
	    "Takes points of a sensor: float32 or float64 [n, 3] or [rows, columns, 3], not copied. stamp: seconds, above that of the sensor's\n"
	    "frame before. pose: of the sensor in the world. robot, state: its own body is left out. Returns counts." );
	type.def( "insert_depth", &insertDepth, "depth"_a, "intrinsics"_a, "stamp"_a, nb::kw_only(), "pose"_a = nb::none(),
	    "scale"_a = nb::none(), "sensor"_a = 0, "near"_a = 0.0, "far"_a = infinity, "trust_far"_a = false, "clears"_a = true,
	    "robot"_a.none() = nb::none(), "state"_a = nb::none(),
	    nb::sig(
	        "def insert_depth(self, depth: numpy.typing.NDArray[typing.Any], intrinsics: numpy.typing.ArrayLike, stamp: float, *, "
	        "pose: numpy.typing.ArrayLike | None = None, scale: float | None = None, sensor: int = 0, near: float = 0.0, "
	        "far: float = float('inf'), trust_far: bool = False, clears: bool = True, robot: Checker | None = None, "
	        "state: numpy.typing.ArrayLike | None = None) -> dict[str, int]" ),
	    "Takes a depth image: uint16 (millimetres) or float32 (metres) [height, width], not copied. intrinsics: fx, fy, cx, cy, or the\n"
	    "matrix [3, 3]. pose: of the optical frame, x right, y down, z forward. scale: metres of depth 1. Others as insert_points()." );
	type.def( "insert_message", &insertMessage, "data"_a, "fields"_a, "width"_a, "point_step"_a, "stamp"_a, nb::kw_only(),
	    "pose"_a = nb::none(), "height"_a = 1, "row_step"_a = nb::none(), "is_bigendian"_a = false, "sensor"_a = 0,
	    "near"_a = 0.0, "far"_a = infinity, "trust_far"_a = false, "clears"_a = true, "robot"_a.none() = nb::none(),
	    "state"_a = nb::none(),
	    nb::sig(
	        "def insert_message(self, data: bytes, fields: Mapping[str, tuple[int, int]], width: int, point_step: int, "
	        "stamp: float, *, pose: numpy.typing.ArrayLike | None = None, height: int = 1, row_step: int | None = None, "
	        "is_bigendian: bool = False, sensor: int = 0, near: float = 0.0, far: float = float('inf'), "
	        "trust_far: bool = False, clears: bool = True, robot: Checker | None = None, "
	        "state: numpy.typing.ArrayLike | None = None) -> dict[str, int]" ),
	    "Takes the bytes of a sensor_msgs/PointCloud2. fields: name to (offset, datatype), with x, y and z. Others as insert_points()." );
}

} // namespace

void bindClouds( nb::module_& module )
{
	nb::class_<PyCloud> type( module, "Cloud",
	    "Voxels that depth cameras and scanners fill and clear. World.see() makes a checker of it; earlier checkers stay as they were." );
	type.def( "__init__", &makeCloud, nb::kw_only(), "resolution"_a = 0.01, "box"_a = nb::none(), "unseen"_a = "free",
	    "sensor_error"_a = 0.0, "clear_margin"_a = nb::none(), "shadow"_a = 0.02,
	    "jump_distance"_a = std::numeric_limits<double>::infinity(),
	    "jump_angle"_a = std::numeric_limits<double>::infinity(), "most_blocks"_a = 65536, "threads"_a = 1,
	    nb::sig(
	        "def __init__(self, *, resolution: float = 0.01, box: numpy.typing.ArrayLike | None = None, unseen: str = 'free', "
	        "sensor_error: float = 0.0, clear_margin: float | None = None, shadow: float = 0.02, "
	        "jump_distance: float = float('inf'), jump_angle: float = float('inf'), most_blocks: int = 65536, threads: int = 1) -> None" ),
	    "box: least and greatest corner in the world, [2, 3]; None: 2 m around the origin. unseen: 'free' or 'blocked'. Lengths in metres,\n"
	    "angles in radians, as in leeway/cloud.h. threads: for the rays of a frame and the shapes of World.see(); 0 = one per core." );
	bindFrames( type );
	type.def( "set_box", &setBox, "low"_a, "high"_a, "state"_a,
	    nb::sig( "def set_box(self, low: numpy.typing.ArrayLike, high: numpy.typing.ArrayLike, state: str) -> None" ),
	    "Makes the voxels of a box 'occupied', 'free' or 'unseen'." );
	type.def(
	    "forget_before",
	    []( PyCloud& cloud, double stamp )
	    { return alone( cloud, [&]( io::Cloud& c ) { return lw_cloud_forget_before( c.get(), stamp ); } ); },
	    "stamp"_a, "Forgets voxels that were hit last before `stamp`. Returns how many." );
	type.def(
	    "clear", []( PyCloud& cloud ) { alone( cloud, []( io::Cloud& c ) { lw_cloud_clear( c.get() ); } ); },
	    "Forgets everything." );
	type.def(
	    "allow_jump",
	    []( PyCloud& cloud, const Whole& sensor )
	    {
		    const auto number = static_cast<std::uint32_t>( sensor.in( "sensor", 0, LW_CLOUD_SENSORS - 1 ) );
		    alone( cloud, [&]( io::Cloud& c ) { lw_cloud_allow_jump( c.get(), number ); } );
	    },
	    "sensor"_a = 0, nb::sig( "def allow_jump(self, sensor: int = 0) -> None" ),
	    "The next frame of the sensor may come from anywhere." );
	type.def( "voxels", &voxels, "state"_a = "occupied",
	    nb::sig( "def voxels(self, state: str = 'occupied') -> numpy.typing.NDArray[numpy.float64]" ),
	    "Centres of the voxels that are 'occupied', or 'free': float64 [n, 3]." );
	type.def( "states", &states, "points"_a,
	    nb::sig( "def states(self, points: numpy.typing.ArrayLike) -> numpy.typing.NDArray[numpy.uint8]" ),
	    "States of the voxels of points [n, 3]: 0 unseen, 1 free, 2 occupied." );
	type.def(
	    "read_octomap",
	    []( PyCloud& cloud, const std::filesystem::path& file )
	    { alone( cloud, [&]( io::Cloud& c ) { c.readOctomap( file.string() ); } ); },
	    "file"_a, "Adds the free and occupied cells of an octomap, .bt or .ot." );
	type.def(
	    "write_octomap",
	    []( PyCloud& cloud, const std::filesystem::path& file )
	    { alone( cloud, [&]( io::Cloud& c ) { c.writeOctomap( file.string() ); } ); },
	    "file"_a, "Writes an octomap: .ot, or else .bt." );
	type.def_prop_ro( "info", &cloudInfo, nb::sig( "def info(self) -> dict[str, typing.Any]" ),
	    "Counts, and `excess`: clearances to the cloud are below those to the points by no more than this." );
	type.def( "__repr__",
	    []( PyCloud& cloud )
	    {
		    const lw_cloud_info info = alone( cloud, []( io::Cloud& c ) { return lw_cloud_get_info( c.get() ); } );
		    return "<leeway.Cloud: " + std::to_string( info.occupied ) + " voxels of " + std::to_string( info.resolution ) +
		           " m>";
	    } );
	type.def( "__reduce__", &refusePickle );
}

} // namespace leeway::python
