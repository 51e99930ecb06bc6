// SPDX-License-Identifier: BSD-3-Clause
// xacro as a program of others: its search path, its packages, its words in errors and notices.
#include "tools/xacro.hpp"

#include "tools/process.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>

namespace leeway::tools
{

namespace
{

/// Exit status of the interpreter if it lacks the module.
constexpr int no_module = 117;
const char* const run_module =
    "import sys\ntry:\n    from xacro import main\nexcept ImportError:\n    sys.exit(117)\nmain()\n";

/// The module that xacro asks for the folder of $(find NAME). It stands in front of ROS's own, and looks where leeway looks for
/// package://NAME; then for a folder upwards whose package.xml has the name.
const char* const packages_module = R"py(import os, re

FILE_FOLDER, *PATHS = os.environ["LEEWAY_XACRO_SEARCH"].split("\n")


class PackageNotFoundError(LookupError):
    pass


def split(name):
    return [entry for entry in os.environ.get(name, "").split(":") if entry]


def upwards():
    folder = os.path.abspath(FILE_FOLDER)
    while True:
        yield folder
        if folder == os.path.dirname(folder):
            return
        folder = os.path.dirname(folder)


def named_by_manifest(folder, name):
    try:
        with open(os.path.join(folder, "package.xml"), encoding="utf-8") as stream:
            return re.search(r"<name>\s*" + re.escape(name) + r"\s*</name>", stream.read(1 << 20)) is not None
    except (OSError, UnicodeDecodeError):
        return False


def candidates(name):
    def entry_or_below(entry):
        return ([entry] if os.path.basename(os.path.normpath(entry)) == name else []) + [os.path.join(entry, name)]

    for entry in PATHS:
        mapped, equals, folder = entry.partition("=")
        if not equals or os.path.isdir(entry):
            yield from entry_or_below(entry)
        elif mapped == name:
            yield folder
    for entry in split("ROS_PACKAGE_PATH"):
        yield from entry_or_below(entry)
    for entry in split("AMENT_PREFIX_PATH"):
        yield os.path.join(entry, "share", name)
    for folder in upwards():
        yield from entry_or_below(folder)
    for folder in upwards():
        if named_by_manifest(folder, name):
            yield folder


def get_package_share_directory(name, print_warning=True):
    for folder in candidates(name):
        if os.path.isdir(folder):
            return os.path.abspath(folder)
    raise PackageNotFoundError("package " + name + " was not found; give --package-path " + name + "=FOLDER (Python: packages)")
)py";

std::vector<std::string> findXacro( const XacroSettings& settings )
{
	const char* given = std::getenv( "LEEWAY_XACRO" );
	if ( given != nullptr && *given != '\0' )
	{
		if ( !isProgram( given ) )
		{
			throw io::Error( given, "$LEEWAY_XACRO", "is no program", "name xacro's file, such as /usr/local/bin/xacro" );
		}
		return { given };
	}
	if ( const std::string found = findOnPath( { "xacro" } ); !found.empty() )
	{
		return { found };
	}
	const std::string python = isProgram( settings.python ) ? settings.python : findOnPath( { settings.python } );
	return python.empty() ? std::vector<std::string>() : std::vector<std::string>{ python, "-c", run_module };
}

/// Without the sequences that colour a terminal, and the blanks at its ends.
std::string plainText( const std::string& text )
{
	std::string plain;
	for ( std::size_t i = 0; i < text.size(); ++i )
	{
		if ( text[i] == '\x1b' && i + 1 < text.size() && text[i + 1] == '[' )
		{
			i = std::min( text.find( 'm', i ), text.size() );
			continue;
		}
		plain += text[i];
	}
	const std::size_t first = plain.find_first_not_of( " \t\r\n" );
	return first == std::string::npos ? "" : plain.substr( first, plain.find_last_not_of( " \t\r\n" ) - first + 1 );
}

std::string listedWords( const std::vector<std::string>& words )
{
	std::string list;
	for ( const std::string& word : words )
	{
		list += " " + word;
	}
	return list;
}

[[noreturn]] void refuseWithoutXacro( const std::string& file )
{
	throw io::Error( file, "<robot>",
	    "this is a xacro file, and the program xacro was not found, by $LEEWAY_XACRO, on $PATH or as a module of Python",
	    fmt::format(
	        "install it (pip install xacro; with ROS: apt-get install ros-DISTRIBUTION-xacro), or expand the file where "
	        "it is: xacro {} > robot.urdf",
	        file ) );
}

} // namespace

bool isXacroArgument( const std::string& word )
{
	const std::size_t end = word.find( ":=" );
	const auto is_letter = []( char c )
	{ return ( c >= 'a' && c <= 'z' ) || ( c >= 'A' && c <= 'Z' ) || ( c >= '0' && c <= '9' ) || c == '_'; };
	return end != std::string::npos && end > 0 &&
	       std::all_of( word.begin(), word.begin() + static_cast<std::ptrdiff_t>( end ), is_letter ) &&
	       word.find( '\0' ) == std::string::npos;
}

io::ExpandedRobot expandXacro( const std::string& file, const XacroSettings& settings )
{
	for ( const std::string& argument : settings.arguments )
	{
		if ( !isXacroArgument( argument ) )
		{
			throw io::Error( file, "argument " + argument, "is none of xacro", "write NAME:=VALUE" );
		}
	}
	std::error_code error;
	if ( !std::filesystem::is_regular_file( file, error ) )
	{
		throw io::Error( file, "<robot>", "this is a xacro file in a stream, and xacro reads files", "save it as a file" );
	}
	Command command;
	command.words = findXacro( settings );
	if ( command.words.empty() )
	{
		refuseWithoutXacro( file );
	}
	const std::string program = command.words.front();
	const std::string absolute = std::filesystem::absolute( file ).string(); // no name of a file is an option
	command.words.push_back( absolute );
	command.words.insert( command.words.end(), settings.arguments.begin(), settings.arguments.end() );

	const TemporaryFolder folder;
	folder.write( "ament_index_python/__init__.py", "from .packages import *\n" );
	folder.write( "ament_index_python/packages.py", packages_module );
	std::string search = std::filesystem::path( absolute ).parent_path().string();
	for ( const std::string& path : settings.package_paths )
	{
		search += "\n" + path;
	}
	const char* python_path = std::getenv( "PYTHONPATH" );
	const std::string others = python_path != nullptr && *python_path != '\0' ? std::string( ":" ) + python_path : "";
	command.environment = { { "PYTHONPATH", folder.path() + others }, { "LEEWAY_XACRO_SEARCH", search },
	    { "PYTHONDONTWRITEBYTECODE", "1" }, { "PYTHONUTF8", "1" } };
	const Run run = runProgram( command );
	if ( run.ending == Ending::exited && run.status == no_module )
	{
		refuseWithoutXacro( file );
	}
	const std::string words = plainText( run.err );
	if ( !run.succeeded() )
	{
		throw io::Error( file, "xacro",
		    fmt::format( "{} {}{}", program, endingText( run, command ), words.empty() ? "" : ": " + words ),
		    fmt::format(
		        "correct the file or its arguments; alone it is: xacro {}{}", file, listedWords( settings.arguments ) ) );
	}
	io::ExpandedRobot expanded{ run.out, { { file, "xacro", "was expanded by " + program } } };
	if ( !words.empty() )
	{
		expanded.notices.push_back( { file, "xacro", "said: " + words } );
	}
	return expanded;
}

} // namespace leeway::tools
