// SPDX-License-Identifier: BSD-3-Clause
// Where a mesh URI points: package:// and model:// by given paths, environments of Gazebo, ROS and ament, then upwards from the naming file.
#include "base/io_internal.hpp"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fmt/format.h>
#include <sstream>

namespace leeway::io::detail
{

namespace fs = std::filesystem;

namespace
{

const std::string package_scheme = "package://", model_scheme = "model://";

/// package://NAME/PATH of ROS, or model://NAME/PATH of Gazebo.
bool hasPackage( const std::string& uri )
{
	return uri.compare( 0, package_scheme.size(), package_scheme ) == 0 ||
	       uri.compare( 0, model_scheme.size(), model_scheme ) == 0;
}

/// NAME and PATH of such a URI. With slashes in front of NAME (package:///NAME/PATH, an empty authority) it means the same, as in
/// pinocchio.
struct PackageUri
{
	explicit PackageUri( const std::string& uri )
	{
		const std::size_t begin = uri.find_first_not_of( '/', uri.find( "://" ) + 3 );
		const std::string rest = begin != std::string::npos ? uri.substr( begin ) : "";
		const std::size_t slash = rest.find( '/' );
		name = rest.substr( 0, slash );
		path = slash != std::string::npos ? rest.substr( slash + 1 ) : "";
	}

	std::string name, path;
};

/// The folder's own name, whether or not the path ends in a slash.
std::string folderName( const fs::path& folder )
{
	fs::path normal = folder.lexically_normal();
	return normal.has_filename() ? normal.filename().string() : normal.parent_path().filename().string();
}

/// Tries one path after the other and records every path that it tried.
class Search
{
public:
	explicit Search( std::vector<std::string>& tried ) : m_tried( tried ) {}

	/// @return true if the candidate, or an earlier one, is a file
	bool at( const fs::path& candidate )
	{
		std::string path = candidate.lexically_normal().string();
		std::error_code error;
		if ( fs::is_regular_file( path, error ) )
		{
			m_found = path;
		}
		m_tried.push_back( path + whyNot( path, error ) );
		return !m_found.empty();
	}

	/// A search entry either is the package or contains it.
	bool inEntry( const fs::path& entry, const std::string& package, const std::string& path )
	{
		return ( folderName( entry ) == package && at( entry / path ) ) || at( entry / package / path );
	}

	const std::string& found() const { return m_found; }

private:
	/// What is there instead of a file, in brackets; empty if there is nothing, or a file.
	static std::string whyNot( const std::string& path, std::error_code error )
	{
		if ( error && error != std::errc::no_such_file_or_directory && error != std::errc::not_a_directory )
		{
			return fmt::format( " ({})", error.message() );
		}
		const std::string kind = fileKind( path );
		return kind.empty() ? "" : fmt::format( " ({}, not a file)", kind );
	}

	std::vector<std::string>& m_tried;
	std::string m_found;
};

bool searchEnvironment(
    const char* variable, const std::string& package, const std::string& path, bool ament, Search& search )
{
	const char* value = std::getenv( variable );
	std::istringstream entries( value != nullptr ? value : "" );
	for ( std::string entry; std::getline( entries, entry, ':' ); )
	{
		if ( entry.empty() )
		{
			continue;
		}
		if ( ament ? search.at( fs::path( entry ) / "share" / package / path ) : search.inEntry( entry, package, path ) )
		{
			return true;
		}
	}
	return false;
}

void searchPackage( const std::string& package, const std::string& path, const fs::path& from_folder,
    const LoadOptions& options, Search& search )
{
	for ( const std::string& entry : options.package_paths )
	{
		std::size_t equals = entry.find( '=' );
		std::error_code error;
		if ( equals == std::string::npos || fs::is_directory( entry, error ) )
		{
			if ( search.inEntry( entry, package, path ) )
			{
				return;
			}
		}
		else if ( entry.substr( 0, equals ) == package && search.at( fs::path( entry.substr( equals + 1 ) ) / path ) )
		{
			return;
		}
	}
	if ( searchEnvironment( "GZ_SIM_RESOURCE_PATH", package, path, false, search ) ||
	     searchEnvironment( "GAZEBO_MODEL_PATH", package, path, false, search ) ||
	     searchEnvironment( "ROS_PACKAGE_PATH", package, path, false, search ) ||
	     searchEnvironment( "AMENT_PREFIX_PATH", package, path, true, search ) )
	{
		return;
	}
	for ( fs::path folder = from_folder; !search.inEntry( folder, package, path ) && folder != folder.parent_path(); )
	{
		folder = folder.parent_path();
	}
}

/// The reason why a URI cannot name a file in any folder; empty if it can.
std::string uriProblem( const std::string& uri )
{
	const std::size_t colon = uri.find( "://" );
	const std::string scheme = colon != std::string::npos ? uri.substr( 0, colon ) : "";
	if ( scheme == "package" || scheme == "model" )
	{
		return PackageUri( uri ).name.empty() ? "names no package" : "";
	}
	return scheme.empty() || scheme == "file" ? "" : fmt::format( "begins with {}://, which is not known", scheme );
}

/// A file that was found, and the guess that led to it.
struct Resolved
{
	std::string file;           ///< empty if there is none
	std::string element, guess; ///< of the notice; empty without a guess
};

/// package://FILE, without a package: in the given folders, then from the folder of the naming file upwards.
Resolved resolveWithoutPackage(
    const std::string& name, const fs::path& from_folder, const LoadOptions& options, Search& search )
{
	bool found = false;
	for ( const std::string& entry : options.package_paths )
	{
		found = found || search.at( fs::path( entry ) / name );
	}
	for ( fs::path folder = from_folder; !found && !search.at( folder / name ) && folder != folder.parent_path(); )
	{
		folder = folder.parent_path();
	}
	return { search.found(), "package://",
	    "URIs that name a file and no package, such as package://" + name +
	        ", were taken as paths: in the package paths, then from the folder of this file upwards" };
}

/// The nearest folder upwards that has the file, whatever its name: a clone of a package often has another one.
Resolved guessPackage( const PackageUri& parts, const fs::path& from_folder, Search& search )
{
	for ( fs::path folder = from_folder;; folder = folder.parent_path() )
	{
		if ( search.at( folder / parts.path ) )
		{
			return { search.found(), "package " + parts.name,
			    fmt::format(
			        "was found under that name nowhere; {} has the file {}, and was taken for it: say so by --package-path "
			        "{}={} (Python: packages), or name the right folder",
			        folder.string(), parts.path, parts.name, folder.string() ) };
		}
		if ( folder == folder.parent_path() )
		{
			return {};
		}
	}
}

/// A path with a folder, such as meshes/arm.stl: the nearest folder upwards that has it. xacro files are often written for a robot.urdf elsewhere.
Resolved guessFolder( const std::string& uri, const fs::path& from_folder )
{
	const fs::path path = fs::path( uri ).lexically_normal();
	std::vector<std::string> guessed;
	Search search( guessed );
	for ( fs::path folder = from_folder; path.is_relative() && path.has_parent_path() && folder != folder.parent_path(); )
	{
		folder = folder.parent_path();
		if ( search.at( folder / path ) )
		{
			return { search.found(), "relative paths",
			    fmt::format(
			        "{} is not below the folder of this file; it was taken from {}", path.string(), folder.string() ) };
		}
	}
	return {};
}

/// @param tried receives every path that was tried, in order; those of guesses are in it only if one is right
Resolved resolveUri(
    const std::string& uri, const std::string& from_file, const LoadOptions& options, std::vector<std::string>& tried )
{
	const std::string file_scheme = "file://";
	fs::path from_folder = fs::absolute( from_file ).lexically_normal().parent_path();
	Search search( tried );
	if ( hasPackage( uri ) )
	{
		const PackageUri parts( uri );
		if ( parts.path.empty() )
		{
			return resolveWithoutPackage( parts.name, from_folder, options, search );
		}
		searchPackage( parts.name, parts.path, from_folder, options, search );
		if ( search.found().empty() )
		{
			std::vector<std::string> guessed;
			Search guesses( guessed );
			return guessPackage( parts, from_folder, guesses );
		}
	}
	else if ( uri.compare( 0, file_scheme.size(), file_scheme ) == 0 )
	{
		search.at( from_folder / uri.substr( file_scheme.size() ) );
	}
	else if ( !search.at( from_folder / uri ) ) // an absolute path replaces the folder
	{
		return guessFolder( uri, from_folder );
	}
	return { search.found(), "", "" };
}

/// One notice of each guess, whose text names the first file.
void noticeGuess( const Resolved& resolved, const std::string& from_file, std::vector<Notice>& notices )
{
	const auto same = [&]( const Notice& notice ) { return notice.file == from_file && notice.element == resolved.element; };
	if ( !resolved.guess.empty() && std::none_of( notices.begin(), notices.end(), same ) )
	{
		notices.push_back( { from_file, resolved.element, resolved.guess } );
	}
}

} // namespace

std::string findResource( const char* kind, const std::string& uri, const std::string& from_file, const std::string& element,
    const LoadOptions& options, std::vector<Notice>& notices )
{
	if ( const std::string problem = uriProblem( uri ); !problem.empty() )
	{
		throw Error( from_file, element, fmt::format( "{} \"{}\" {}", kind, uri, problem ),
		    "write package://NAME/PATH, file:///PATH, or a path from the folder of this file" );
	}
	std::vector<std::string> tried;
	const Resolved resolved = resolveUri( uri, from_file, options, tried );
	if ( !resolved.file.empty() )
	{
		noticeGuess( resolved, from_file, notices );
		return resolved.file;
	}
	const bool package = hasPackage( uri );
	const PackageUri parts( uri );
	throw Error( from_file, element,
	    fmt::format( "{} {} {}was not found, tried {}", kind, uri,
	        package && parts.path.empty()
	            ? fmt::format( "names package {} and no file in it, and as a file it ", parts.name )
	            : "",
	        joinNames( tried, 12 ) ),
	    package ? "put the package beside the file, name its folder as a package path (--package-path), or set "
	              "ROS_PACKAGE_PATH or AMENT_PREFIX_PATH"
	            : "correct the path" );
}

bool hasResource( const std::string& uri, const std::string& from_file, const LoadOptions& options )
{
	std::vector<std::string> tried;
	return uriProblem( uri ).empty() && !resolveUri( uri, from_file, options, tried ).file.empty();
}

} // namespace leeway::io::detail
