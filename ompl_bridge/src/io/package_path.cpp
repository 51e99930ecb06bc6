// SPDX-License-Identifier: BSD-3-Clause
// Where a mesh URI points: package:// by given paths, ROS and ament environments, then upwards from the naming file.
#include "io_internal.hpp"

#include <cstdlib>
#include <filesystem>
#include <fmt/format.h>
#include <sstream>

namespace leeway::io::detail
{

namespace fs = std::filesystem;

namespace
{

/// The folder's own name, whether or not the path ends in a slash.
std::string folderName( const fs::path& folder )
{
	fs::path normal = folder.lexically_normal();
	return normal.has_filename() ? normal.filename().string() : normal.parent_path().filename().string();
}

/// A search entry either is the package or contains it.
void addEntry( const fs::path& entry, const std::string& package, const std::string& path, std::vector<fs::path>& out )
{
	if ( folderName( entry ) == package )
	{
		out.push_back( entry / path );
	}
	out.push_back( entry / package / path );
}

void addEnvironment(
    const char* variable, const std::string& package, const std::string& path, bool ament, std::vector<fs::path>& out )
{
	const char* value = std::getenv( variable );
	std::istringstream entries( value != nullptr ? value : "" );
	for ( std::string entry; std::getline( entries, entry, ':' ); )
	{
		if ( entry.empty() )
		{
			continue;
		}
		if ( ament )
		{
			out.push_back( fs::path( entry ) / "share" / package / path );
		}
		else
		{
			addEntry( entry, package, path, out );
		}
	}
}

std::vector<fs::path> packageCandidates(
    const std::string& package, const std::string& path, const fs::path& from_folder, const LoadOptions& options )
{
	std::vector<fs::path> candidates;
	for ( const std::string& entry : options.package_paths )
	{
		std::size_t equals = entry.find( '=' );
		std::error_code error;
		if ( equals == std::string::npos || fs::is_directory( entry, error ) )
		{
			addEntry( entry, package, path, candidates );
		}
		else if ( entry.substr( 0, equals ) == package )
		{
			candidates.push_back( fs::path( entry.substr( equals + 1 ) ) / path );
		}
	}
	addEnvironment( "ROS_PACKAGE_PATH", package, path, false, candidates );
	addEnvironment( "AMENT_PREFIX_PATH", package, path, true, candidates );
	for ( fs::path folder = from_folder;; folder = folder.parent_path() )
	{
		addEntry( folder, package, path, candidates );
		if ( folder == folder.parent_path() )
		{
			return candidates;
		}
	}
}

} // namespace

std::string resolveUri(
    const std::string& uri, const std::string& from_file, const LoadOptions& options, std::vector<std::string>& tried )
{
	const std::string package_scheme = "package://", file_scheme = "file://";
	fs::path from_folder = fs::absolute( from_file ).lexically_normal().parent_path();
	std::vector<fs::path> candidates;
	if ( uri.compare( 0, package_scheme.size(), package_scheme ) == 0 )
	{
		std::string rest = uri.substr( package_scheme.size() );
		std::size_t slash = rest.find( '/' );
		if ( slash == 0 || slash == std::string::npos )
		{
			return ""; // no package name, or nothing in it
		}
		candidates = packageCandidates( rest.substr( 0, slash ), rest.substr( slash + 1 ), from_folder, options );
	}
	else if ( uri.compare( 0, file_scheme.size(), file_scheme ) == 0 )
	{
		candidates.push_back( from_folder / uri.substr( file_scheme.size() ) );
	}
	else
	{
		candidates.push_back( from_folder / uri ); // an absolute path replaces the folder
	}
	for ( const fs::path& candidate : candidates )
	{
		std::string path = candidate.lexically_normal().string();
		tried.push_back( path );
		std::error_code error;
		if ( fs::is_regular_file( path, error ) )
		{
			return path;
		}
	}
	return "";
}

std::string findResource( const char* kind, const std::string& uri, const std::string& from_file, const std::string& element,
    const LoadOptions& options )
{
	std::vector<std::string> tried;
	std::string file = resolveUri( uri, from_file, options, tried );
	if ( !file.empty() )
	{
		return file;
	}
	bool package = uri.compare( 0, 10, "package://" ) == 0;
	throw Error( from_file, element,
	    tried.empty() ? fmt::format( "\"{}\" names no file", uri )
	                  : fmt::format( "{} {} was not found, tried {}", kind, uri, joinNames( tried, 12 ) ),
	    package ? "put the package beside the file, name its folder as a package path, or set ROS_PACKAGE_PATH or "
	              "AMENT_PREFIX_PATH"
	            : "correct the path" );
}

} // namespace leeway::io::detail
