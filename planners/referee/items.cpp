// SPDX-License-Identifier: BSD-3-Clause
#include "referee/items.hpp"

#include "leeway/motions/path_file.hpp"
#include "motions/csv.hpp"
#include "motions/yaml_values.hpp"
#include "referee/arrays.hpp"
#include "referee/splines.hpp"

#include <fmt/format.h>

#include <filesystem>

namespace leeway::referee
{
namespace
{

using motions::child;

std::vector<std::vector<double>> numberRows( const std::string& file, const YAML::Node& node, const std::string& element )
{
	if ( !node.IsDefined() || !node.IsSequence() || node.size() == 0 )
	{
		throw io::Error( file, element, "is no list of rows", "give lists of numbers" );
	}
	std::vector<std::vector<double>> rows;
	for ( std::size_t i = 0; i < node.size(); ++i )
	{
		const std::size_t count = i == 0 && node[0].IsSequence() ? node[0].size() : i == 0 ? 0 : rows[0].size();
		rows.push_back( motions::numberList(
		    file, node[i], fmt::format( "{}[{}]", element, i ), count, "give all rows the same count of numbers" ) );
	}
	return rows;
}

bool isRegion( const YAML::Node& node )
{
	return child( node, "A" ).IsDefined() && child( node, "b" ).IsDefined();
}

Region regionOf( const std::string& file, const YAML::Node& node, const std::string& element )
{
	Region region;
	region.file = file;
	region.element = element;
	const std::string before = element.empty() ? "" : element + ".";
	region.a = numberRows( file, node["A"], before + "A" );
	region.b = motions::numberList( file, node["b"], before + "b", region.a.size(), "give a number for each row of A" );
	if ( child( node, "joint_names" ).IsDefined() )
	{
		region.joint_names = motions::nameList( file, node["joint_names"], before + "joint_names" );
	}
	region.name = element;
	return region;
}

/// Regions of a file; none if it holds something else.
std::vector<Region> regionsOf( const std::string& file, const YAML::Node& root )
{
	std::vector<Region> regions;
	if ( isRegion( root ) )
	{
		return { regionOf( file, root, "" ) };
	}
	const YAML::Node list = child( root, "regions" ).IsDefined() ? root["regions"] : root;
	for ( std::size_t i = 0; list.IsSequence() && i < list.size() && isRegion( list[i] ); ++i )
	{
		regions.push_back( regionOf( file, list[i], fmt::format( "regions[{}]", i ) ) );
	}
	if ( list.IsMap() )
	{
		for ( const auto& entry : list )
		{
			if ( isRegion( entry.second ) )
			{
				regions.push_back( regionOf( file, entry.second, entry.first.Scalar() ) );
			}
		}
	}
	if ( !regions.empty() && list.size() != regions.size() + ( child( list, "joint_names" ).IsDefined() ? 1 : 0 ) )
	{
		throw io::Error(
		    file, "regions", "some of its entries have no A and b", "give A and b to each, or remove the others" );
	}
	if ( child( root, "joint_names" ).IsDefined() )
	{
		for ( Region& region : regions )
		{
			if ( region.joint_names.empty() )
			{
				region.joint_names = motions::nameList( file, root["joint_names"], "joint_names" );
			}
		}
	}
	return regions;
}

std::vector<motions::Segment> bsplineOf( const std::string& file, const YAML::Node& node, const std::string& element )
{
	const double order = motions::finiteValue( file, child( node, "order" ), element + ".order" );
	if ( !( order >= 2 && order <= LW_CURVE_MOST_DEGREE + 1 && order == static_cast<unsigned>( order ) ) )
	{
		throw io::Error( file, element + ".order",
		    fmt::format( "{:g} is not a whole number of 2 to {}", order, LW_CURVE_MOST_DEGREE + 1 ),
		    "give order = degree + 1" );
	}
	const std::vector<std::vector<double>> points =
	    numberRows( file, child( node, "control_points" ), element + ".control_points" );
	const std::vector<double> knots = motions::numberList( file, child( node, "knots" ), element + ".knots",
	    points.size() + static_cast<std::size_t>( order ), "give control points + order knots" );
	return fromBspline( static_cast<unsigned>( order ), knots, points, file, element );
}

std::vector<motions::Segment> bezierOf( const std::string& file, const YAML::Node& node, const std::string& element )
{
	const double begin = motions::finiteValue( file, child( node, "start" ), element + ".start" );
	const double end = motions::finiteValue( file, child( node, "end" ), element + ".end" );
	return { fromBezier(
	    begin, end, numberRows( file, child( node, "control_points" ), element + ".control_points" ), file, element ) };
}

std::vector<motions::Segment> polynomialsOf( const std::string& file, const YAML::Node& node, const std::string& element )
{
	const YAML::Node pieces = child( node, "coefficients" );
	const std::size_t count = pieces.IsDefined() && pieces.IsSequence() ? pieces.size() : 0;
	const std::vector<double> breaks = motions::numberList(
	    file, child( node, "breaks" ), element + ".breaks", count + 1, "give one break more than pieces of coefficients" );
	std::vector<motions::Segment> segments;
	for ( std::size_t i = 0; i < count; ++i )
	{
		const std::string place = fmt::format( "{}.coefficients[{}]", element, i );
		segments.push_back( fromPowers( breaks[i], breaks[i + 1], numberRows( file, pieces[i], place ), file, place ) );
	}
	return segments;
}

/// Of a map that has one of the keys; empty if it has none.
std::vector<motions::Segment> splineOf( const std::string& file, const YAML::Node& node, const std::string& before )
{
	if ( child( node, "bspline" ).IsDefined() )
	{
		return bsplineOf( file, node["bspline"], before + "bspline" );
	}
	if ( child( node, "bezier" ).IsDefined() )
	{
		return bezierOf( file, node["bezier"], before + "bezier" );
	}
	if ( child( node, "piecewise_polynomial" ).IsDefined() )
	{
		return polynomialsOf( file, node["piecewise_polynomial"], before + "piecewise_polynomial" );
	}
	std::vector<motions::Segment> segments;
	const YAML::Node parts = child( node, "composite" );
	for ( std::size_t i = 0; parts.IsDefined() && parts.IsSequence() && i < parts.size(); ++i )
	{
		const std::string place = fmt::format( "{}composite[{}].", before, i );
		const std::vector<motions::Segment> part = splineOf( file, parts[i], place );
		if ( part.empty() )
		{
			throw io::Error( file, place, "holds none of bspline, bezier, piecewise_polynomial", "give one of them" );
		}
		segments.insert( segments.end(), part.begin(), part.end() );
	}
	return segments;
}

/// Points that have no times: MoveIt's without time_from_start, and leeway's own paths.
bool isPath( const YAML::Node& root )
{
	const YAML::Node under = child( root, "joint_trajectory" );
	const YAML::Node points = child( under.IsDefined() ? under : root, "points" );
	return points.IsDefined() && points.IsSequence() && points.size() > 0 &&
	       !child( points[0], "time_from_start" ).IsDefined();
}

std::vector<Item> itemsOfYaml( const std::string& file )
{
	std::size_t bytes = 0;
	const std::vector<YAML::Node> documents = motions::loadYaml( file, &bytes );
	const YAML::Node root = documents.size() == 1 ? documents[0] : YAML::Node( YAML::NodeType::Undefined );
	std::vector<Item> items;
	for ( Region& region : documents.size() == 1 ? regionsOf( file, root ) : std::vector<Region>() )
	{
		Item item;
		item.element = region.element;
		item.region = std::move( region );
		items.push_back( std::move( item ) );
	}
	if ( !items.empty() )
	{
		return items;
	}
	Item item;
	if ( documents.size() == 1 )
	{
		item.segments = splineOf( file, root, "" );
	}
	if ( !item.segments.empty() )
	{
		if ( child( root, "joint_names" ).IsDefined() )
		{
			item.joint_names = motions::nameList( file, root["joint_names"], "joint_names" );
		}
		return { item };
	}
	if ( documents.size() == 1 && isPath( root ) )
	{
		motions::PathFile path = motions::readPath( file );
		item.joint_names = path.joint_names;
		item.points = path.points;
		item.start_state = path.start_state;
		item.notices = path.notices;
		return { item };
	}
	for ( motions::TrajectoryFile& trajectory : motions::readTrajectories( file ) )
	{
		Item one;
		one.element = trajectory.element;
		one.notices = trajectory.notices;
		one.trajectory = std::move( trajectory );
		items.push_back( std::move( one ) );
	}
	return items;
}

std::vector<Item> itemsOfCsv( const std::string& file )
{
	const motions::CsvTable table = motions::readCsv( file );
	Item item;
	if ( std::find( table.header.begin(), table.header.end(), "time" ) != table.header.end() )
	{
		item.trajectory = motions::readTrajectories( file ).front();
		item.notices = item.trajectory->notices;
		return { item };
	}
	item.joint_names = table.header;
	for ( std::size_t row = 0; row < table.rows.size(); ++row )
	{
		item.points.emplace_back();
		for ( std::size_t column = 0; column < table.header.size(); ++column )
		{
			item.points.back().push_back( table.value( row, column ) );
		}
	}
	return { item };
}

} // namespace

std::vector<Item> readItems( const std::string& file )
{
	const std::string ending = std::filesystem::path( file ).extension().string();
	std::vector<Item> items;
	if ( ending == ".npy" || ending == ".txt" )
	{
		for ( std::vector<std::vector<double>>& points : ending == ".npy" ? readNpy( file ) : readMatrix( file ) )
		{
			items.emplace_back();
			items.back().points = std::move( points );
			items.back().element = fmt::format( "[{}]", items.size() - 1 );
		}
		if ( items.size() == 1 )
		{
			items.front().element.clear();
		}
	}
	else
	{
		items = ending == ".csv" ? itemsOfCsv( file ) : itemsOfYaml( file );
	}
	for ( Item& item : items )
	{
		item.file = file;
		item.name = std::filesystem::path( file ).filename().string() + ( item.element.empty() ? "" : " " + item.element );
		if ( !item.trajectory && !item.region && item.segments.empty() && item.points.empty() )
		{
			throw io::Error( file, item.element, "has no points", "give one state or more" );
		}
	}
	return items;
}

} // namespace leeway::referee
