// SPDX-License-Identifier: BSD-3-Clause
// Robots from files: the format by content, then the SRDF, or neighbours without one.
#include "base/xml.hpp"
#include "mjcf/robot.hpp"
#include "robot/neighbours.hpp"
#include "robot/plausibility.hpp"
#include "robot/urdf_reader.hpp"

#include <cstring>
#include <filesystem>

namespace leeway::io
{

namespace detail
{

namespace
{

bool isMjcf( const XmlFile& xml )
{
	const tinyxml2::XMLElement* root = xml.document().RootElement();
	return root != nullptr && std::strcmp( root->Name(), "mujoco" ) == 0;
}

} // namespace

RobotModel readRobot( std::unique_ptr<XmlFile> xml, const LoadOptions& options )
{
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

} // namespace

RobotModel loadRobot( const std::string& urdf_file, const std::string& srdf_file, const LoadOptions& options )
{
	auto xml = std::make_unique<detail::XmlFile>( urdf_file );
	const bool mjcf = detail::isMjcf( *xml );
	RobotModel model = detail::readRobot( std::move( xml ), options );
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
