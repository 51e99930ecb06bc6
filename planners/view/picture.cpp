// SPDX-License-Identifier: BSD-3-Clause
// Pictures of pages, drawn by a browser without a window.
#include "view/page.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <fcntl.h>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

namespace leeway::view
{
namespace
{

namespace fs = std::filesystem;

constexpr double most_seconds = 120; // of the browser

/// A folder for the page and the browser's own files; removed with the object.
class Folder
{
public:
	Folder()
	{
		std::string name = ( fs::temp_directory_path() / "leeway-view-XXXXXX" ).string();
		if ( mkdtemp( name.data() ) == nullptr )
		{
			throw io::Error( name, "folder", std::strerror( errno ), "set TMPDIR to a folder that can be written" );
		}
		m_path = name;
	}
	~Folder()
	{
		std::error_code ignored;
		fs::remove_all( m_path, ignored );
	}
	Folder( const Folder& ) = delete;
	Folder& operator=( const Folder& ) = delete;
	fs::path operator/( const char* name ) const { return m_path / name; }

private:
	fs::path m_path;
};

bool isProgram( const fs::path& path )
{
	std::error_code error;
	return fs::is_regular_file( path, error ) && access( path.c_str(), X_OK ) == 0;
}

/// The first browser of $PATH, or that of $LEEWAY_BROWSER.
std::string findBrowser()
{
	const char* given = std::getenv( "LEEWAY_BROWSER" );
	if ( given != nullptr && *given != '\0' )
	{
		if ( !isProgram( given ) )
		{
			throw io::Error( given, "$LEEWAY_BROWSER", "is no program", "name a Chromium, such as /usr/bin/chromium" );
		}
		return given;
	}
	const char* path = std::getenv( "PATH" );
	for ( const char* name : { "chromium", "chromium-browser", "google-chrome", "google-chrome-stable" } )
	{
		std::string rest = path != nullptr ? path : "";
		while ( !rest.empty() )
		{
			const std::size_t colon = rest.find( ':' );
			const fs::path candidate = fs::path( rest.substr( 0, colon ) ) / name;
			if ( isProgram( candidate ) )
			{
				return candidate.string();
			}
			rest = colon == std::string::npos ? "" : rest.substr( colon + 1 );
		}
	}
	throw io::Error( "command line", "--png", "no Chromium was found, which draws the picture",
	    "install one (Debian: apt-get install chromium), name one in $LEEWAY_BROWSER, or write the page by --out and open it" );
}

/// Runs a program without input and output until it ends. False if it takes too long or fails.
bool runQuietly( const std::vector<std::string>& command )
{
	std::vector<char*> arguments;
	arguments.reserve( command.size() + 1 );
	for ( const std::string& word : command )
	{
		arguments.push_back( const_cast<char*>( word.c_str() ) );
	}
	arguments.push_back( nullptr );
	const pid_t child = fork();
	if ( child == 0 )
	{
		const int null = open( "/dev/null", O_RDWR );
		for ( const int stream : { 0, 1, 2 } )
		{
			dup2( null, stream );
		}
		setpgid( 0, 0 );
		execv( arguments[0], arguments.data() );
		_exit( 127 );
	}
	const auto start = std::chrono::steady_clock::now();
	const auto seconds = [start]
	{ return std::chrono::duration<double>( std::chrono::steady_clock::now() - start ).count(); };
	int status = -1;
	pid_t ended = 0;
	while ( child > 0 && ( ended = waitpid( child, &status, WNOHANG ) ) == 0 && seconds() < most_seconds )
	{
		std::this_thread::sleep_for( std::chrono::milliseconds( 50 ) );
	}
	if ( child > 0 && ended == 0 ) // its own processes with it
	{
		kill( -child, SIGKILL );
		waitpid( child, &status, 0 );
	}
	return child > 0 && ended == child && WIFEXITED( status ) && WEXITSTATUS( status ) == 0;
}

} // namespace

std::string pagePicture( const std::string& html, const PictureOptions& options )
{
	const std::string browser = findBrowser();
	const Folder folder;
	const fs::path page = folder / "page.html", png = folder / "page.png";
	std::ofstream( page, std::ios::binary ) << html;
	const std::string address = fmt::format( "file://{}#picture=1{}{}{}{}", page.string(),
	    options.camera.empty() ? "" : "&camera=", options.camera, options.at.empty() ? "" : "&at=", options.at );
	std::vector<std::string> command = { browser, "--headless=new", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
	    "--disable-dev-shm-usage", // containers have little of it
	    "--hide-scrollbars", "--no-first-run", "--disable-extensions", "--user-data-dir=" + ( folder / "profile" ).string(),
	    fmt::format( "--window-size={},{}", options.width, options.height ), "--virtual-time-budget=15000",
	    "--screenshot=" + png.string(), address };
	if ( geteuid() == 0 )
	{
		command.insert( command.begin() + 1, "--no-sandbox" ); // Chromium's own rule for root
	}
	const bool drawn = runQuietly( command );
	std::ifstream file( png, std::ios::binary );
	std::string bytes( std::istreambuf_iterator<char>( file ), {} );
	if ( !drawn || bytes.empty() )
	{
		throw io::Error( options.file, "the picture", fmt::format( "{} drew none", browser ),
		    "write the page by --out and open it; or name another Chromium in $LEEWAY_BROWSER" );
	}
	return bytes;
}

} // namespace leeway::view
