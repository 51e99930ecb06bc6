// SPDX-License-Identifier: BSD-3-Clause
// leeway.Scene: obstacles from MoveIt files and from arrays. leeway.Margins and leeway.Padding.
#include "objects.hpp"

#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <filesystem>

namespace leeway::python
{

namespace
{

using namespace nb::literals;

[[noreturn]] void refuse( const std::string& text )
{
	throw nb::value_error( text.c_str() );
}

void makeScene( PyScene* self, const std::filesystem::path& file, const std::vector<std::string>& packages, double detail,
    const std::string& cache )
{
	const nb::gil_scoped_release unlocked;
	io::SceneModel model;
	if ( !file.empty() )
	{
		io::LoadOptions options;
		options.package_paths = packages;
		options.detail = detail;
		options.cache = cache;
		model = io::loadScene( file.string(), options );
	}
	new ( self ) PyScene{ std::move( model ) };
}

std::vector<io::SceneObject>::iterator findObject( PyScene& scene, const std::string& name )
{
	return std::find_if( scene.model.objects.begin(), scene.model.objects.end(),
	    [&name]( const io::SceneObject& object ) { return object.name == name; } );
}

void addObject(
    PyScene& scene, const std::string& name, const nb::object& shapes, const nb::object& pose, const std::string& frame )
{
	if ( name.empty() || findObject( scene, name ) != scene.model.objects.end() )
	{
		refuse( "object '" + name + "': the scene has one of this name, or it is empty; choose another name" );
	}
	io::SceneObject object;
	object.name = name;
	object.frame = frame;
	object.pose = poseOrIdentity( pose, "pose" );
	object.shapes = placedShapes( shapes );
	for ( io::PlacedShape& placed : object.shapes )
	{
		placed.pose = lw_transform_multiply( &object.pose, &placed.pose );
	}
	scene.model.objects.push_back( std::move( object ) );
}

void removeObject( PyScene& scene, const std::string& name )
{
	const auto found = findObject( scene, name );
	if ( found == scene.model.objects.end() )
	{
		refuse( "object '" + name + "': the scene has none of this name" );
	}
	scene.model.objects.erase( found );
}

std::vector<std::string> objectNames( const PyScene& scene )
{
	std::vector<std::string> names;
	for ( const io::SceneObject& object : scene.model.objects )
	{
		names.push_back( object.name );
	}
	return names;
}

nb::list objectShapes( const PyScene& scene, const std::string& name )
{
	nb::list out;
	for ( const io::SceneObject& object : scene.model.objects )
	{
		for ( std::size_t i = 0; object.name == name && i < object.shapes.size(); ++i )
		{
			out.append( nb::make_tuple( object.shapes[i].shape, poseArray( object.shapes[i].pose ) ) );
		}
	}
	return out;
}

std::string sceneRepr( const PyScene& scene )
{
	std::size_t shapes = 0;
	for ( const io::SceneObject& object : scene.model.objects )
	{
		shapes += object.shapes.size();
	}
	return "<leeway.Scene" + ( scene.model.name.empty() ? "" : " " + scene.model.name ) + ": " +
	       std::to_string( scene.model.objects.size() ) + " objects, " + std::to_string( shapes ) + " shapes, " +
	       std::to_string( scene.model.attached.size() ) + " attached to the robot>";
}

void bindMargins( nb::module_& module )
{
	using Pairs = std::map<std::pair<std::string, std::string>, double>;
	using Names = std::map<std::string, double>;
	nb::class_<io::Margins>( module, "Margins",
	    "Metres that are subtracted from distances: of all pairs, of single links and objects, of single pairs." )
	    .def(
	        "__init__",
	        []( io::Margins* self, double environment, double self_margin, Names links, Names self_links, Names objects,
	            Pairs pairs )
	        {
		        new ( self ) io::Margins{ "margins", environment, self_margin, std::move( links ), std::move( self_links ),
		            std::move( objects ), std::move( pairs ) };
	        },
	        nb::kw_only(), "environment"_a = 0.0, "self_collision"_a = 0.0, "links"_a = Names(), "self_links"_a = Names(),
	        "objects"_a = Names(), "pairs"_a = Pairs(),
	        "environment, self_collision: of all pairs. links, self_links, objects: added, by name. pairs: (link, object) or (link, link)\n"
	        "to exactly this margin." )
	    .def_static(
	        "load", []( const std::filesystem::path& file ) { return io::loadMargins( file.string() ); }, "file"_a,
	        "Reads a YAML file of margins." )
	    .def( "__repr__",
	        []( const io::Margins& m )
	        {
		        return "<leeway.Margins: environment " + std::to_string( m.environment ) + " m, self " +
		               std::to_string( m.self ) + " m, " +
		               std::to_string( m.links.size() + m.self_links.size() + m.objects.size() + m.pairs.size() ) +
		               " others>";
	        } );
	nb::class_<io::Padding>( module, "Padding", "MoveIt's padding (metres) and scale (factors) of links and objects." )
	    .def(
	        "__init__",
	        []( io::Padding* self, double robot, double robot_scale, double object, double attached, Names links,
	            Names scales ) {
		        new ( self ) io::Padding{ robot, robot_scale, object, attached, std::move( links ), std::move( scales ) };
	        },
	        nb::kw_only(), "robot"_a = 0.0, "robot_scale"_a = 1.0, "object"_a = 0.0, "attached"_a = 0.0, "links"_a = Names(),
	        "link_scales"_a = Names() )
	    .def_static(
	        "load", []( const std::filesystem::path& file ) { return io::loadPadding( file.string() ); }, "file"_a,
	        "Reads MoveIt's parameters default_robot_padding and others from a YAML file." )
	    .def( "__repr__",
	        []( const io::Padding& p ) {
		        return "<leeway.Padding: robot " + std::to_string( p.robot ) + " m, objects " + std::to_string( p.object ) +
		               " m>";
	        } );
}

} // namespace

std::vector<io::PlacedShape> placedShapes( const nb::object& shapes )
{
	std::vector<io::PlacedShape> placed;
	if ( nb::isinstance<Shape>( shapes ) )
	{
		placed.push_back( { nb::cast<Shape>( shapes ), lw_transform_identity() } );
		return placed;
	}
	for ( const nb::handle item : nb::iter( shapes ) )
	{
		if ( nb::isinstance<Shape>( item ) )
		{
			placed.push_back( { nb::cast<Shape>( item ), lw_transform_identity() } );
			continue;
		}
		const nb::tuple pair( nb::borrow( item ) );
		if ( nb::len( pair ) != 2 || !nb::isinstance<Shape>( pair[0] ) )
		{
			refuse( "shapes: give a Shape, or a list of Shape and (Shape, pose)" );
		}
		placed.push_back( { nb::cast<Shape>( pair[0] ), poseOrIdentity( nb::borrow( pair[1] ), "pose of a shape" ) } );
	}
	if ( placed.empty() )
	{
		refuse( "shapes: the list is empty; give at least one Shape" );
	}
	return placed;
}

void bindScenes( nb::module_& module )
{
	nb::class_<PyScene> type( module, "Scene",
	    "Obstacles by name, with the allowed contacts, attached objects and robot state of a MoveIt planning scene. A checker or a\n"
	    "world copies it: later changes need World." );
	type.def( "__init__", &makeScene, "file"_a = "", nb::kw_only(), "packages"_a = std::vector<std::string>(),
	    "detail"_a = 0.0, "cache"_a = "",
	    "Reads a planning scene (MoveIt .scene, YAML) or a URDF; without a file the scene is empty. Options as for Robot." );
	type.def( "add", &addObject, "name"_a, "shapes"_a, "pose"_a = nb::none(), "frame"_a = "",
	    nb::sig( "def add(self, name: str, shapes: Shape | Sequence[Shape | tuple[Shape, numpy.typing.ArrayLike]], "
	             "pose: numpy.typing.ArrayLike | None = None, frame: str = '') -> None" ),
	    "Adds an object. shapes: a Shape, or a list of Shape and (Shape, pose in the object). pose: of the object, a 4 x 4 matrix,\n"
	    "x y z, or x y z qx qy qz qw, in `frame` (empty: the planning frame)." );
	type.def( "remove", &removeObject, "name"_a, "Removes an object." );
	type.def_prop_ro( "objects", &objectNames, "Names of the objects." );
	type.def( "shapes", &objectShapes, "name"_a,
	    nb::sig( "def shapes(self, name: str) -> list[tuple[Shape, numpy.typing.NDArray[numpy.float64]]]" ),
	    "Shapes of an object with their poses [4, 4] in the object's frame of reference." );
	type.def(
	    "allow",
	    []( PyScene& scene, const std::string& a, const std::string& b ) { scene.model.allowed.emplace_back( a, b ); },
	    "a"_a, "b"_a, "Allows contact of two links or objects." );
	type.def_prop_ro(
	    "notices", []( const PyScene& s ) { return noticeLines( s.model.report.notices ); },
	    "Lines on input that the reader changed, assumed or ignored." );
	type.def( "__repr__", &sceneRepr );
	type.def( "__getstate__", &sceneState );
	type.def( "__setstate__",
	    []( PyScene& scene, const nb::tuple& state ) { new ( &scene ) PyScene( sceneFromState( state ) ); } );
	bindMargins( module );
}

} // namespace leeway::python
