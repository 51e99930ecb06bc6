// SPDX-License-Identifier: BSD-3-Clause
// Pictures of pages, drawn by a browser without a window.
#include "view/page.hpp"

#include "tools/process.hpp"

#include <fmt/format.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <unistd.h>

namespace leeway::view
{
namespace
{

constexpr double most_seconds = 120; // of the browser

/// The first browser of $PATH, or that of $LEEWAY_BROWSER.
std::string findBrowser()
{
	const char* given = std::getenv( "LEEWAY_BROWSER" );
	if ( given != nullptr && *given != '\0' )
	{
		if ( !tools::isProgram( given ) )
		{
			throw io::Error( given, "$LEEWAY_BROWSER", "is no program", "name a Chromium, such as /usr/bin/chromium" );
		}
		return given;
	}
	const std::string found =
	    tools::findOnPath( { "chromium", "chromium-browser", "google-chrome", "google-chrome-stable" } );
	if ( !found.empty() )
	{
		return found;
	}
	throw io::Error( "command line", "--png", "no Chromium was found, which draws the picture",
	    "install one (Debian: apt-get install chromium), name one in $LEEWAY_BROWSER, or write the page by --out and open it" );
}

} // namespace

std::string pagePicture( const std::string& html, const PictureOptions& options )
{
	const std::string browser = findBrowser();
	const tools::TemporaryFolder folder;
	const std::string page = folder.write( "page.html", html ), png = folder.path() + "/page.png";
	const std::string address = fmt::format( "file://{}#picture=1{}{}{}{}", page,
	    options.camera.empty() ? "" : "&camera=", options.camera, options.at.empty() ? "" : "&at=", options.at );
	tools::Command command;
	command.seconds = most_seconds;
	command.words = { browser, "--headless=new", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
	    "--disable-dev-shm-usage", // containers have little of it
	    "--hide-scrollbars", "--no-first-run", "--disable-extensions", "--user-data-dir=" + folder.path() + "/profile",
	    fmt::format( "--window-size={},{}", options.width, options.height ), "--virtual-time-budget=15000",
	    "--screenshot=" + png, address };
	if ( geteuid() == 0 )
	{
		command.words.insert( command.words.begin() + 1, "--no-sandbox" ); // Chromium's own rule for root
	}
	const bool drawn = tools::runProgram( command ).succeeded();
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
