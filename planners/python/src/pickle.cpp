// SPDX-License-Identifier: BSD-3-Clause
// Pickling: shapes as a blob with their trees, everything else as plain values. A state of another version is refused.
#include "objects.hpp"

#include <nanobind/stl/array.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <array>
#include <cstring>
#include <map>
#include <tuple>

namespace leeway::python
{

namespace
{

constexpr lw_digest key = { { 0x6c656577617920ULL, 1 } }; // the version of these states
using Numbers12 = std::array<double, 12>;
using PlacedState = std::pair<std::uint32_t, Numbers12>;

nb::bytes blobOf( const std::vector<const lw_shape*>& shapes )
{
	lw_blob_def def = lw_blob_def_default();
	def.key = key;
	def.shapes = shapes.data();
	def.shape_count = static_cast<std::uint32_t>( shapes.size() );
	void* bytes = nullptr;
	std::size_t size = 0;
	lw_diag diag{};
	lw_status status = LW_OK;
	{
		const nb::gil_scoped_release unlocked;
		for ( std::size_t i = 0; i < shapes.size() && status == LW_OK; ++i )
		{
			status = lw_shape_complete( shapes[i], &diag );
		}
		status = status == LW_OK ? lw_blob_write( &def, nullptr, &diag, &bytes, &size ) : status;
	}
	require( status, diag );
	nb::bytes out( bytes, size );
	lw_blob_free( nullptr, bytes, size );
	return out;
}

std::vector<Shape> shapesOf( const nb::bytes& blob )
{
	lw_diag diag{};
	lw_blob_info info{};
	require( lw_blob_get_info( blob.data(), blob.size(), &diag, &info ), diag );
	std::vector<lw_shape*> read( info.shape_count );
	std::vector<Shape> shapes;
	shapes.reserve( read.size() );
	if ( info.shape_count > 0 )
	{
		require( lw_blob_read_shapes( blob.data(), blob.size(), key, nullptr, &diag, read.data(), info.shape_count ), diag );
	}
	for ( lw_shape* shape : read )
	{
		shapes.push_back( Shape::adopt( shape ) );
	}
	return shapes;
}

Numbers12 numbersOf( const lw_transform& transform )
{
	Numbers12 out;
	static_assert( sizeof( out ) == sizeof( transform ) );
	std::memcpy( out.data(), &transform, sizeof( transform ) );
	return out;
}

lw_transform transformOf( const Numbers12& numbers )
{
	lw_transform out;
	std::memcpy( &out, numbers.data(), sizeof( out ) );
	return out;
}

/// Shapes by number, each once.
class ShapeTable
{
public:
	std::vector<PlacedState> add( const std::vector<io::PlacedShape>& placed )
	{
		std::vector<PlacedState> out;
		for ( const io::PlacedShape& one : placed )
		{
			const auto [found, fresh] = m_index.emplace( one.shape.get(), static_cast<std::uint32_t>( m_shapes.size() ) );
			if ( fresh )
			{
				m_shapes.push_back( one.shape.get() );
			}
			out.emplace_back( found->second, numbersOf( one.pose ) );
		}
		return out;
	}
	nb::bytes blob() const { return blobOf( m_shapes ); }

private:
	std::map<const lw_shape*, std::uint32_t> m_index;
	std::vector<const lw_shape*> m_shapes;
};

std::vector<io::PlacedShape> placedOf( const std::vector<PlacedState>& state, const std::vector<Shape>& shapes )
{
	std::vector<io::PlacedShape> out;
	out.reserve( state.size() );
	for ( const auto& [index, numbers] : state )
	{
		out.push_back( { shapes.at( index ), transformOf( numbers ) } );
	}
	return out;
}

// ---- parts -----------------------------------------------------------------------------------------------------------

using Strings = std::vector<std::string>;
using NoticeState = std::tuple<std::string, std::string, std::string>;
using LinkState = std::pair<std::string, std::vector<PlacedState>>;
using JointState = std::tuple<std::string, int, std::string, std::string, Numbers12, std::array<double, 3>, double, double,
    double, std::string, double, double>;
using GroupState = std::tuple<std::string, Strings, Strings, std::string>;
using NamedState = std::tuple<std::string, std::string, std::map<std::string, std::vector<double>>, std::string>;
using ObjectState = std::tuple<std::string, std::string, std::vector<PlacedState>, Numbers12>;

std::vector<NoticeState> noticeStates( const std::vector<io::Notice>& notices )
{
	std::vector<NoticeState> out;
	out.reserve( notices.size() );
	for ( const io::Notice& notice : notices )
	{
		out.emplace_back( notice.file, notice.element, notice.text );
	}
	return out;
}

std::vector<io::Notice> noticesOf( const std::vector<NoticeState>& state )
{
	std::vector<io::Notice> out;
	out.reserve( state.size() );
	for ( const auto& [file, element, text] : state )
	{
		out.push_back( { file, element, text } );
	}
	return out;
}

JointState jointState( const io::JointModel& j )
{
	return { j.name, static_cast<int>( j.type ), j.parent, j.child, numbersOf( j.parent_from_joint ),
	    { j.axis[0], j.axis[1], j.axis[2] }, j.lower, j.upper, j.velocity, j.mimic, j.mimic_multiplier, j.mimic_offset };
}

io::JointModel jointOf( const JointState& state )
{
	io::JointModel j;
	int type = 0;
	Numbers12 pose;
	std::array<double, 3> axis;
	std::tie( j.name, type, j.parent, j.child, pose, axis, j.lower, j.upper, j.velocity, j.mimic, j.mimic_multiplier,
	    j.mimic_offset ) = state;
	j.type = static_cast<lw_joint_type>( type );
	j.parent_from_joint = transformOf( pose );
	std::copy( axis.begin(), axis.end(), j.axis );
	return j;
}

ObjectState objectState( const io::SceneObject& object, ShapeTable& table )
{
	return { object.name, object.frame, table.add( object.shapes ), numbersOf( object.pose ) };
}

io::SceneObject objectOf( const ObjectState& state, const std::vector<Shape>& shapes )
{
	io::SceneObject object;
	object.name = std::get<0>( state );
	object.frame = std::get<1>( state );
	object.shapes = placedOf( std::get<2>( state ), shapes );
	object.pose = transformOf( std::get<3>( state ) );
	return object;
}

template <typename T> T item( const nb::tuple& state, std::size_t i )
{
	return nb::cast<T>( state[i] );
}

void requireSize( const nb::tuple& state, std::size_t size, const char* name )
{
	if ( nb::len( state ) != size )
	{
		throw CoreError(
		    LW_ERROR_STALE, std::string( "pickle of a " ) + name + ": was made by another version; read its files again" );
	}
}

// ---- robots ----------------------------------------------------------------------------------------------------------

nb::tuple modelState( const io::RobotModel& model )
{
	ShapeTable table;
	std::vector<LinkState> links;
	for ( const io::LinkModel& link : model.links )
	{
		links.emplace_back( link.name, table.add( link.collision ) );
	}
	std::vector<JointState> joints;
	for ( const io::JointModel& joint : model.joints )
	{
		joints.push_back( jointState( joint ) );
	}
	std::vector<std::tuple<std::string, std::string, std::string>> disabled;
	for ( const io::DisabledPair& pair : model.disabled )
	{
		disabled.emplace_back( pair.link1, pair.link2, pair.reason );
	}
	std::vector<GroupState> groups;
	for ( const io::Group& group : model.groups )
	{
		groups.emplace_back( group.name, group.joints, group.links, group.defect );
	}
	std::vector<NamedState> states;
	for ( const io::GroupState& state : model.group_states )
	{
		states.emplace_back( state.name, state.group, state.joints, state.defect );
	}
	const Strings names = { model.name, model.urdf_file, model.srdf_file, model.root_link, model.planning_frame };
	return nb::make_tuple( table.blob(), names, links, joints, disabled, groups, states,
	    noticeStates( model.report.notices ), model.report.links_without_geometry );
}

io::RobotModel modelOf( const nb::tuple& state )
{
	requireSize( state, 9, "robot" );
	const std::vector<Shape> shapes = shapesOf( item<nb::bytes>( state, 0 ) );
	const auto names = item<Strings>( state, 1 );
	io::RobotModel model;
	model.name = names.at( 0 );
	model.urdf_file = names.at( 1 );
	model.srdf_file = names.at( 2 );
	model.root_link = names.at( 3 );
	model.planning_frame = names.at( 4 );
	for ( const auto& [name, placed] : item<std::vector<LinkState>>( state, 2 ) )
	{
		model.links.push_back( { name, placedOf( placed, shapes ) } );
	}
	for ( const JointState& joint : item<std::vector<JointState>>( state, 3 ) )
	{
		model.joints.push_back( jointOf( joint ) );
	}
	for ( const auto& [a, b, reason] : item<std::vector<NoticeState>>( state, 4 ) )
	{
		model.disabled.push_back( { a, b, reason } );
	}
	for ( const auto& [name, joints, links, defect] : item<std::vector<GroupState>>( state, 5 ) )
	{
		model.groups.push_back( { name, joints, links, defect } );
	}
	for ( const auto& [name, group, joints, defect] : item<std::vector<NamedState>>( state, 6 ) )
	{
		model.group_states.push_back( { name, group, joints, defect } );
	}
	model.report.notices = noticesOf( item<std::vector<NoticeState>>( state, 7 ) );
	model.report.links_without_geometry = item<Strings>( state, 8 );
	return model;
}

// ---- scenes ----------------------------------------------------------------------------------------------------------

using AttachedState = std::tuple<ObjectState, std::string, Strings>;
using FrameState = std::tuple<std::string, std::string, Numbers12>;

nb::list articulationStates( const io::SceneModel& scene )
{
	nb::list out;
	for ( const io::Articulation& a : scene.articulations )
	{
		out.append( nb::make_tuple( a.name, a.frame, numbersOf( a.pose ), modelState( a.model ), a.values, a.objects ) );
	}
	return out;
}

io::Articulation articulationOf( const nb::tuple& state )
{
	requireSize( state, 6, "scene" );
	io::Articulation a;
	a.name = item<std::string>( state, 0 );
	a.frame = item<std::string>( state, 1 );
	a.pose = transformOf( item<Numbers12>( state, 2 ) );
	a.model = modelOf( item<nb::tuple>( state, 3 ) );
	a.robot = io::buildRobot( a.model );
	a.values = item<std::vector<double>>( state, 4 );
	a.objects = item<Strings>( state, 5 );
	return a;
}

} // namespace

nb::bytes shapeState( const Shape& shape )
{
	return blobOf( { shape.get() } );
}

Shape shapeFromState( const nb::bytes& bytes )
{
	std::vector<Shape> shapes = shapesOf( bytes );
	if ( shapes.size() != 1 )
	{
		throw CoreError( LW_ERROR_DAMAGED, "pickle of a shape: holds " + std::to_string( shapes.size() ) + " shapes" );
	}
	return shapes.front();
}

nb::tuple robotState( const PyRobot& robot )
{
	return modelState( *robot.model );
}

PyRobot robotFromState( const nb::tuple& state )
{
	return PyRobot( modelOf( state ) );
}

nb::tuple sceneState( const PyScene& scene )
{
	const io::SceneModel& model = scene.model;
	ShapeTable table;
	std::vector<ObjectState> objects;
	for ( const io::SceneObject& object : model.objects )
	{
		objects.push_back( objectState( object, table ) );
	}
	std::vector<AttachedState> attached;
	for ( const io::AttachedObject& one : model.attached )
	{
		attached.emplace_back( objectState( one.object, table ), one.link, one.touch_links );
	}
	std::vector<FrameState> frames;
	for ( const auto& [child, frame] : model.fixed_frames )
	{
		frames.emplace_back( child, frame.first, numbersOf( frame.second ) );
	}
	const Strings names = { model.name, model.file };
	return nb::make_tuple( table.blob(), names, objects, attached, model.state.values, model.allowed, model.default_allowed,
	    model.matrix_names, frames, model.link_padding, model.link_scale, noticeStates( model.report.notices ),
	    articulationStates( model ) );
}

PyScene sceneFromState( const nb::tuple& state )
{
	requireSize( state, 13, "scene" );
	const std::vector<Shape> shapes = shapesOf( item<nb::bytes>( state, 0 ) );
	const auto names = item<Strings>( state, 1 );
	io::SceneModel model;
	model.name = names.at( 0 );
	model.file = names.at( 1 );
	for ( const ObjectState& object : item<std::vector<ObjectState>>( state, 2 ) )
	{
		model.objects.push_back( objectOf( object, shapes ) );
	}
	for ( const auto& [object, link, touch] : item<std::vector<AttachedState>>( state, 3 ) )
	{
		model.attached.push_back( { objectOf( object, shapes ), link, touch } );
	}
	model.state.values = item<std::map<std::string, double>>( state, 4 );
	model.allowed = item<std::vector<std::pair<std::string, std::string>>>( state, 5 );
	model.default_allowed = item<Strings>( state, 6 );
	model.matrix_names = item<Strings>( state, 7 );
	for ( const auto& [child, frame, pose] : item<std::vector<FrameState>>( state, 8 ) )
	{
		model.fixed_frames.emplace( child, std::pair( frame, transformOf( pose ) ) );
	}
	model.link_padding = item<std::map<std::string, double>>( state, 9 );
	model.link_scale = item<std::map<std::string, double>>( state, 10 );
	model.report.notices = noticesOf( item<std::vector<NoticeState>>( state, 11 ) );
	for ( const nb::handle articulation : item<nb::list>( state, 12 ) )
	{
		model.articulations.push_back( articulationOf( nb::cast<nb::tuple>( articulation ) ) );
	}
	return { std::move( model ) };
}

} // namespace leeway::python
