// SPDX-License-Identifier: BSD-3-Clause
// Robots from files: the format by content, then the SRDF, or neighbours without one.
#include "base/xml.hpp"
#include "mjcf/robot.hpp"
#include "robot/neighbours.hpp"
#include "robot/plausibility.hpp"
#include "robot/urdf_reader.hpp"
#if LEEWAY_SDF
#include "sdf/sdf.hpp"
#endif

#include <cstring>
#include <filesystem>

namespace leeway::io
{

namespace detail
{

namespace
{

bool hasRoot( const XmlFile& xml, const char* name )
{
	const tinyxml2::XMLElement* root = xml.document().RootElement();
	return root != nullptr && std::strcmp( root->Name(), name ) == 0;
}

bool isMjcf( const XmlFile& xml )
{
	return hasRoot( xml, "mujoco" );
}

} // namespace

RobotModel readRobot( std::unique_ptr<XmlFile> xml, const LoadOptions& options )
{
#if LEEWAY_SDF
	if ( hasRoot( *xml, "sdf" ) )
	{
		return readSdf( xml->path(), options );
	}
#endif
	return isMjcf( *xml ) ? readMjcf( std::move( xml ), options ) : readUrdf( *xml, options );
}

} // namespace detail

namespace
{

/// A path that is no folder finds nothing, also where another one does.
void noticePackagePaths( const LoadOptions& options, std::vector<Notice>& notices )
{
	for ( const std::string& entry : options.package_paths )
	{
		const std::size_t equals = entry.find( '=' );
		std::error_code error;
		const bool mapped =
		    equals != std::string::npos && std::filesystem::is_directory( entry.substr( equals + 1 ), error );
		if ( !mapped && !std::filesystem::is_directory( entry, error ) )
		{
			notices.push_back( { "", "package path " + entry, "is no folder" } );
		}
	}
}

const char* const expanded_text = " of the text that xacro wrote";

/// The robot of a file, before it has an SRDF. @throws Error
RobotModel readFileOrExpanded( std::unique_ptr<detail::XmlFile> xml, const LoadOptions& options )
{
	if ( !options.expand_xacro || !xml->isXacro() )
	{
		return detail::readRobot( std::move( xml ), options );
	}
	const std::string file = xml->path();
	ExpandedRobot expanded = options.expand_xacro( file );
	try
	{
		auto urdf = std::make_unique<detail::XmlFile>( file, expanded.text );
		if ( detail::hasRoot( *urdf, "robot" ) && urdf->root().FirstChildElement( "link" ) == nullptr )
		{
			throw Error( file, "<robot>", "has no link: it may define macros only", "name the file that uses them" );
		}
		RobotModel model = detail::readRobot( std::move( urdf ), options );
		model.expanded_urdf = std::move( expanded.text );
		for ( Notice& notice : model.report.notices )
		{
			notice.element += notice.file == file ? expanded_text : ""; // lines are those of that text
		}
		model.report.notices.insert( model.report.notices.begin(), expanded.notices.begin(), expanded.notices.end() );
		return model;
	}
	catch ( const Error& error )
	{
		throw Error(
		    error.file(), error.element() + ( error.file() == file ? expanded_text : "" ), error.problem(), error.remedy() );
	}
}

} // namespace

RobotModel detail::loadOneRobot(
    const std::string& file, std::string content, const std::string& srdf_file, const LoadOptions& options )
{
	auto xml = std::make_unique<detail::XmlFile>( file, std::move( content ) );
	const bool mjcf = detail::isMjcf( *xml );
	RobotModel model = readFileOrExpanded( std::move( xml ), options );
	noticePackagePaths( options, model.report.notices );
	detail::noticeOddSizes( model, model.report.notices );
	if ( !srdf_file.empty() )
	{
		detail::readSrdf( srdf_file, options.strict, model );
	}
	else if ( !options.strict )
	{
		detail::allowNeighbours( model, !mjcf ); // an MJCF says itself of parent and child
	}
	return model;
}

} // namespace leeway::io
