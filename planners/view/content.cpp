// SPDX-License-Identifier: BSD-3-Clause
#include "view/content.hpp"

#include "view/engine/touching.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace leeway::view
{
namespace
{

Json poseJson( const lw_transform& pose )
{
	Json json = Json::array();
	for ( int i = 0; i < 9; ++i )
	{
		json.push_back( pose.r[i / 3][i % 3] );
	}
	for ( const double t : pose.t )
	{
		json.push_back( t );
	}
	return json;
}

Json jointsJson( const std::vector<io::JointModel>& joints, const lw_robot* robot )
{
	Json json = Json::array();
	for ( std::uint32_t i = 0; i < joints.size(); ++i )
	{
		const io::JointModel& joint = joints[i];
		const std::uint32_t variable = lw_robot_joint_variable( robot, i ),
		                    mimic = lw_robot_find_joint( robot, joint.mimic.c_str() );
		json.push_back( { { "name", joint.name }, { "type", static_cast<int>( joint.type ) },
		    { "parent", lw_robot_joint_parent( robot, i ) }, { "child", lw_robot_joint_child( robot, i ) },
		    { "origin", poseJson( joint.parent_from_joint ) }, { "axis", { joint.axis[0], joint.axis[1], joint.axis[2] } },
		    { "variable", variable == LW_INVALID_INDEX ? -1 : static_cast<int>( variable ) },
		    { "mimic", joint.mimic.empty() || mimic == LW_INVALID_INDEX ? -1 : static_cast<int>( mimic ) },
		    { "multiplier", joint.mimic_multiplier }, { "offset", joint.mimic_offset } } );
	}
	return json;
}

Json variablesJson( const io::Problem& problem )
{
	Json json = Json::array();
	for ( std::uint32_t i = 0; i < lw_robot_variable_count( problem.robot.get() ); ++i )
	{
		const bool in_group = std::find( problem.variables.begin(), problem.variables.end(), i ) != problem.variables.end();
		const lw_variable_info info = lw_robot_variable( problem.robot.get(), i );
		const lw_joint_type type = lw_robot_joint_type( problem.robot.get(), info.joint );
		const bool length = type == LW_JOINT_PRISMATIC || ( type == LW_JOINT_PLANAR && info.component < 2 ) ||
		                    ( type == LW_JOINT_FLOATING && info.component < 3 );
		const bool quaternion = type == LW_JOINT_FLOATING && info.component >= 3;
		json.push_back( { { "name", io::variableName( problem.robot.get(), i ) },
		    { "unit", length       ? "m"
		              : quaternion ? ""
		                           : "rad" },
		    { "lower", jsonNumber( info.lower ) }, { "upper", jsonNumber( info.upper ) }, { "wraps", info.wraps },
		    { "group", in_group } } );
	}
	return json;
}

/// [lower, upper, a, b, margin, point a, point b]; null: not measured.
Json clearanceJson( const lw_clearance& c, double margin )
{
	if ( c.kind == LW_CLEARANCE_UNKNOWN )
	{
		return nullptr;
	}
	const auto index = []( std::uint32_t i ) { return i == LW_INVALID_INDEX ? Json( -1 ) : Json( i ); };
	Json json = { jsonNumber( c.lower ), jsonNumber( c.upper ), index( c.a ), index( c.b ), margin };
	for ( const lw_vec3& p : { c.point_a, c.point_b } )
	{
		for ( const double x : { p.x, p.y, p.z } )
		{
			json.push_back( std::isfinite( c.upper ) ? jsonNumber( x ) : Json( 0 ) );
		}
	}
	return json;
}

Json touchingJson( const PageInput& page, const ViewStep& step )
{
	const lw_state_result& r = step.result;
	Json json = Json::array();
	if ( r.environment.upper <= page.min_d || r.self.upper <= page.min_d )
	{
		lwv_pair pairs[LWV_MOST_PAIRS];
		const std::uint32_t count = lwv_touching( page.problem.checker.get(), step.q.data(), page.flags, page.min_d, pairs );
		for ( std::uint32_t i = 0; i < count; ++i )
		{
			json.push_back( { pairs[i].self ? 1 : 0, pairs[i].a, pairs[i].b } );
		}
	}
	return json;
}

/// For each pair that is the nearest at some step, without those that are set apart: the step at which it is nearest.
Json closestPairs( const ViewMotion& motion )
{
	std::map<std::tuple<int, std::uint32_t, std::uint32_t>, std::pair<double, std::size_t>> least;
	for ( std::size_t i = 0; i < motion.steps.size(); ++i )
	{
		const lw_state_result& r = motion.steps[i].others;
		for ( const lw_clearance* c : { &r.environment, &r.self } )
		{
			if ( std::isfinite( c->upper ) && c->a != LW_INVALID_INDEX && c->b != LW_INVALID_INDEX )
			{
				const std::tuple key( c == &r.self ? 1 : 0, c->a, c->b );
				const auto [found, added] = least.emplace( key, std::pair( c->upper, i ) );
				if ( !added && c->upper < found->second.first )
				{
					found->second = { c->upper, i };
				}
			}
		}
	}
	constexpr std::size_t most_pairs = 40;
	std::vector<std::pair<std::pair<double, std::size_t>, std::tuple<int, std::uint32_t, std::uint32_t>>> sorted;
	sorted.reserve( least.size() );
	for ( const auto& [pair, place] : least )
	{
		sorted.emplace_back( place, pair );
	}
	std::sort( sorted.begin(), sorted.end() );
	sorted.resize( std::min( sorted.size(), most_pairs ) );
	Json json = Json::array();
	for ( const auto& [place, pair] : sorted )
	{
		json.push_back( { { "self", std::get<0>( pair ) }, { "a", std::get<1>( pair ) }, { "b", std::get<2>( pair ) },
		    { "upper", place.first }, { "step", place.second } } );
	}
	return json;
}

Json stateJson( const lw_checker* checker, const lw_state_result& r )
{
	const lw_clearance &e = r.environment, &s = r.self;
	return { { "environment", clearanceJson( e, lw_checker_environment_margin( checker, e.a, e.b ) ) },
	    { "self", clearanceJson( s, lw_checker_self_margin( checker, s.a, s.b ) ) } };
}

Json motionJson( const PageInput& page, const ViewMotion& motion, const std::string& source )
{
	static const char* const units[] = { "none", "seconds", "share", "state" };
	const lw_checker* checker = page.problem.checker.get();
	Json steps = Json::array();
	for ( const ViewStep& step : motion.steps )
	{
		Json json = stateJson( checker, step.result );
		json["at"] = step.at;
		json["q"] = step.q;
		if ( !motion.apart.empty() )
		{
			json["others"] = stateJson( checker, step.others );
		}
		if ( const Json touching = touchingJson( page, step ); !touching.empty() )
		{
			json["touching"] = touching;
		}
		for ( const lwv_pair& pair : step.marked )
		{
			json["marked"].push_back( { pair.self ? 1 : 0, pair.a, pair.b } );
		}
		if ( !step.label.empty() )
		{
			json["label"] = step.label;
		}
		steps.push_back( std::move( json ) );
	}
	Json apart = Json::array();
	for ( const ApartPair& pair : motion.apart )
	{
		apart.push_back( { { "self", pair.pair.self ? 1 : 0 }, { "a", pair.pair.a }, { "b", pair.pair.b },
		    { "least", pair.least }, { "most", pair.most } } );
	}
	double length = 0;
	for ( std::size_t i = 1; i < motion.steps.size(); ++i )
	{
		length += jointDistance( page.problem, motion.steps[i - 1].q, motion.steps[i].q );
	}
	return { { "unit", units[static_cast<int>( motion.unit )] }, { "steps", steps }, { "apart", apart },
	    { "least", leastStep( motion ) }, { "pairs", closestPairs( motion ) }, { "source", source }, { "length", length } };
}

void addModel( const PageInput& page, const ShapeList& shapes, PageContent& content )
{
	const lw_robot* robot = page.problem.robot.get();
	const lw_scene* scene = page.problem.scene.get();
	Json& json = content.json;
	for ( std::uint32_t i = 0; i < lw_robot_link_count( robot ); ++i )
	{
		json["links"].push_back( lw_robot_link_name( robot, i ) );
	}
	json["joints"] = jointsJson( jointsOf( page.robot, robot ), robot );
	json["variables"] = variablesJson( page.problem );
	json["reference"] = page.problem.reference;
	json["group"] = page.problem.variables;
	for ( const io::LinkModel& link : page.robot.links )
	{
		if ( const std::uint32_t i = lw_robot_find_link( robot, link.name.c_str() ); link.colour && i != LW_INVALID_INDEX )
		{
			json["link_colours"].push_back( { { "of", i }, { "rgba", *link.colour } } );
		}
	}
	json["bodies"] = json["objects"] = json["placed"] = Json::array();
	for ( std::uint32_t i = 0; i < lw_robot_body_count( robot ); ++i )
	{
		const lw_body_def body = lw_robot_body( robot, i );
		json["bodies"].push_back( { { "link", body.link }, { "shape", shapes.indexOf( body.shape ) },
		    { "pose", poseJson( body.link_from_shape ) } } );
	}
	for ( std::uint32_t i = 0; scene != nullptr && i < lw_scene_object_count( scene ); ++i )
	{
		json["objects"].push_back( lw_scene_object_name( scene, i ) );
		const std::map<std::string, io::Colour> none, &colours = page.scene != nullptr ? page.scene->colours : none;
		if ( const auto found = colours.find( lw_scene_object_name( scene, i ) ); found != colours.end() )
		{
			json["object_colours"].push_back( { { "of", i }, { "rgba", found->second } } );
		}
	}
	for ( std::uint32_t i = 0; scene != nullptr && i < lw_scene_shape_count( scene ); ++i )
	{
		const lw_scene_shape_def placed = lw_scene_shape( scene, i );
		json["placed"].push_back( { { "object", placed.object }, { "shape", shapes.indexOf( placed.shape ) },
		    { "pose", poseJson( placed.world_from_shape ) } } );
	}
}

} // namespace

ShapeList::ShapeList( const io::Problem& problem )
{
	const lw_robot* robot = problem.robot.get();
	for ( std::uint32_t i = 0; i < lw_robot_body_count( robot ); ++i )
	{
		const lw_body_def body = lw_robot_body( robot, i );
		add( body.shape, std::string( "link " ) + lw_robot_link_name( robot, body.link ) );
	}
	const lw_scene* scene = problem.scene.get();
	for ( std::uint32_t i = 0; scene != nullptr && i < lw_scene_shape_count( scene ); ++i )
	{
		const lw_scene_shape_def placed = lw_scene_shape( scene, i );
		add( placed.shape, std::string( "object " ) + lw_scene_object_name( scene, placed.object ) );
	}
}

void ShapeList::add( const lw_shape* shape, const std::string& owner )
{
	if ( m_index.emplace( shape, m_shapes.size() ).second )
	{
		m_shapes.push_back( shape );
		m_owners.push_back( owner );
	}
}

std::vector<io::JointModel> jointsOf( const io::RobotModel& model, const lw_robot* robot )
{
	std::vector<io::JointModel> joints;
	for ( std::uint32_t i = 0; i < lw_robot_joint_count( robot ); ++i )
	{
		const std::string name = lw_robot_joint_name( robot, i );
		const auto found = std::find_if(
		    model.joints.begin(), model.joints.end(), [&]( const io::JointModel& joint ) { return joint.name == name; } );
		if ( found != model.joints.end() )
		{
			joints.push_back( *found );
			continue;
		}
		io::JointModel fixed; // of an attached object
		fixed.name = name;
		fixed.parent_from_joint = lw_transform_identity();
		joints.push_back( fixed );
	}
	return joints;
}

PageContent pageContent( const PageInput& page )
{
	PageContent content;
	const ShapeList shapes( page.problem );
	content.json = {
	    { "program", fmt::format( "leeway {}.{}.{}", lw_version() / 10000, lw_version() / 100 % 100, lw_version() % 100 ) },
	    { "robot", page.robot.name }, { "group_name", page.problem.group },
	    { "scene", page.scene != nullptr ? page.scene->name : "" }, { "min_d", page.min_d },
	    { "what", static_cast<int>( page.flags ) },
	    { "files", { { "robot", page.robot_file }, { "scene", page.scene_file }, { "motion", page.source } } } };
	addModel( page, shapes, content );
	content.json["shapes"] = shapesJson( shapes, page.triangles, page.progress, content );
	addOverlays( page, content );
	content.json["motion"] = motionJson( page, page.motion, page.source );
	for ( const NamedMotion& one : page.more )
	{
		content.json["more"].push_back( motionJson( page, one.motion, one.name ) );
	}
	for ( const Curve& curve : page.curves )
	{
		Json values = Json::array();
		for ( const double value : curve.values )
		{
			values.push_back( jsonNumber( value ) );
		}
		content.json["curves"].push_back( { { "name", curve.name }, { "unit", curve.unit }, { "values", values } } );
	}
	if ( page.live )
	{
		addEngine( page, shapes, content );
	}
	for ( std::uint32_t i = 0; i < lw_robot_link_count( page.problem.robot.get() ); ++i )
	{
		bool has_body = false;
		for ( std::uint32_t k = 0; k < lw_robot_body_count( page.problem.robot.get() ); ++k )
		{
			has_body = has_body || lw_robot_body( page.problem.robot.get(), k ).link == i;
		}
		if ( !has_body )
		{
			content.json["empty_links"].push_back( i );
		}
	}
	content.json["omitted"] = content.omitted;
	content.json["notes"] = page.notes;
	return content;
}

} // namespace leeway::view
