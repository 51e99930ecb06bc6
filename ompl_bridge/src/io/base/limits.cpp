// SPDX-License-Identifier: BSD-3-Clause
// Limits of input, and the reading of whole files under them.
#include "leeway/io/limits.hpp"

#include "base/io_internal.hpp"
#include "leeway/io/model.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

namespace leeway::io
{

namespace
{

thread_local const Limits* in_force = nullptr;

/// Closed on every way out.
struct Descriptor
{
	explicit Descriptor( int opened ) : number( opened ) {}
	~Descriptor()
	{
		if ( number >= 0 )
		{
			::close( number );
		}
	}
	Descriptor( const Descriptor& ) = delete;
	Descriptor& operator=( const Descriptor& ) = delete;

	const int number;
};

[[noreturn]] void cannotBeRead( const std::string& file, const std::string& why )
{
	throw Error( file, "", "cannot be read" + why, "check its permissions, and that it is not empty" );
}

/// In words; empty for a regular file.
const char* kindOf( mode_t mode )
{
	return S_ISREG( mode )    ? ""
	       : S_ISDIR( mode )  ? "a folder"
	       : S_ISFIFO( mode ) ? "a pipe"
	       : S_ISSOCK( mode ) ? "a socket"
	                          : "a device";
}

[[noreturn]] void refuseUnopened( const std::string& file, int error )
{
	const bool missing = error == ENOENT || error == ENOTDIR;
	throw Error( file, "", missing ? "no such file" : std::string( "cannot be read: " ) + std::strerror( error ),
	    missing ? "check the path" : "check its permissions" );
}

void refuseKind( const std::string& file, mode_t mode )
{
	if ( S_ISDIR( mode ) )
	{
		throw Error( file, "", "is a folder, not a file", "name the file in it" );
	}
	if ( !S_ISREG( mode ) )
	{
		throw Error( file, "", fmt::format( "is {}, not a file", kindOf( mode ) ),
		    "name a file; a shell gives the output of a command by <(COMMAND)" );
	}
}

/// A stream that whoever started the program has opened for it: standard input, and <(COMMAND) of a shell.
bool isStream( const std::string& file )
{
	for ( const std::string folder : { "/dev/fd/", "/proc/self/fd/" } )
	{
		const std::string number = file.compare( 0, folder.size(), folder ) == 0 ? file.substr( folder.size() ) : "";
		if ( !number.empty() && number.find_first_not_of( "0123456789" ) == std::string::npos )
		{
			return true;
		}
	}
	return file == "/dev/stdin";
}

bool sameState( const struct stat& a, const struct stat& b )
{
	return a.st_size == b.st_size && a.st_mtim.tv_sec == b.st_mtim.tv_sec && a.st_mtim.tv_nsec == b.st_mtim.tv_nsec;
}

/// Reads up to the end, in pieces: the size of a pipe, or of a growing file, is not known before.
/// @param stated size of the file, or 0
std::string readToEnd( int descriptor, const std::string& file, std::size_t stated )
{
	constexpr std::size_t piece = std::size_t( 1 ) << 16;
	std::string bytes( stated + 1, '\0' ); // one more, to see the end without another piece
	std::size_t used = 0;
	for ( ;; )
	{
		if ( used == bytes.size() )
		{
			bytes.resize( used + std::max( piece, used / 2 ) );
		}
		const ssize_t count = ::read( descriptor, bytes.data() + used, bytes.size() - used );
		if ( count < 0 && errno != EINTR )
		{
			cannotBeRead( file, fmt::format( " ({})", std::strerror( errno ) ) );
		}
		if ( count == 0 )
		{
			bytes.resize( used );
			return bytes;
		}
		used += count > 0 ? static_cast<std::size_t>( count ) : 0;
		detail::checkLimit( &Limits::file_bytes, used, "bytes", file, "" );
	}
}

std::string checkedBytes( const std::string& file, std::string bytes )
{
	if ( bytes.empty() )
	{
		cannotBeRead( file, "" );
	}
	const std::string pointer = "version https://git-lfs.github.com/spec/";
	if ( bytes.compare( 0, pointer.size(), pointer ) == 0 )
	{
		throw Error( file, "", "is only a pointer of Git LFS: the file itself was not fetched",
		    "run git lfs pull in its repository" );
	}
	return bytes;
}

/// A pipe or a terminal; a device gives numbers without an end.
std::string readStream( const std::string& file )
{
	struct stat found;
	const Descriptor descriptor( ::open( file.c_str(), O_RDONLY | O_CLOEXEC ) );
	if ( descriptor.number < 0 || ::fstat( descriptor.number, &found ) != 0 )
	{
		refuseUnopened( file, errno );
	}
	if ( !S_ISFIFO( found.st_mode ) && ::isatty( descriptor.number ) == 0 )
	{
		refuseKind( file, found.st_mode );
	}
	return checkedBytes( file, readToEnd( descriptor.number, file, 0 ) );
}

} // namespace

const std::vector<std::pair<std::string, std::uint64_t Limits::*>>& limitNames()
{
	static const std::vector<std::pair<std::string, std::uint64_t Limits::*>> names = {
	    { "file_bytes", &Limits::file_bytes },
	    { "triangles", &Limits::triangles },
	    { "points", &Limits::points },
	    { "links", &Limits::links },
	    { "objects", &Limits::objects },
	    { "alias_nodes", &Limits::alias_nodes },
	    { "nesting", &Limits::nesting },
	};
	return names;
}

LimitScope::LimitScope( const Limits& limits ) : m_limits( limits ), m_outer( in_force )
{
	in_force = &m_limits;
}

LimitScope::~LimitScope()
{
	in_force = m_outer;
}

const Limits& currentLimits()
{
	static const Limits defaults;
	return in_force != nullptr ? *in_force : defaults;
}

std::string readWholeFile( const std::string& file )
{
	return isStream( file ) ? readStream( file ) : detail::readFile( file );
}

namespace detail
{

std::string fileKind( const std::string& file )
{
	struct stat found;
	return ::stat( file.c_str(), &found ) == 0 ? kindOf( found.st_mode ) : "";
}

std::string readFile( const std::string& file )
{
	struct stat before, after;
	if ( file.empty() )
	{
		throw Error( file, "", "no file was named", "check the path" );
	}
	if ( ::stat( file.c_str(), &before ) != 0 )
	{
		refuseUnopened( file, errno );
	}
	refuseKind( file, before.st_mode ); // opening a device may do something, and opening a pipe waits for its writer
	const Descriptor descriptor( ::open( file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK ) );
	if ( descriptor.number < 0 || ::fstat( descriptor.number, &before ) != 0 )
	{
		cannotBeRead( file, fmt::format( " ({})", std::strerror( errno ) ) );
	}
	refuseKind( file, before.st_mode ); // replaced meanwhile
	const std::size_t stated = static_cast<std::size_t>( before.st_size );
	checkLimit( &Limits::file_bytes, stated, "bytes", file, "" );
	std::string bytes = readToEnd( descriptor.number, file, stated );
	if ( ::fstat( descriptor.number, &after ) != 0 || !sameState( before, after ) || bytes.size() != stated )
	{
		// Half of one state and half of another is neither
		throw Error( file, "", "changed while it was read", "let whoever writes it finish, then try again" );
	}
	return checkedBytes( file, std::move( bytes ) );
}

void checkLimit( std::uint64_t Limits::*limit, std::uint64_t count, const std::string& what, const std::string& file,
    const std::string& element )
{
	if ( count <= currentLimits().*limit )
	{
		return;
	}
	std::string name;
	for ( const auto& [candidate, member] : limitNames() )
	{
		name = member == limit ? candidate : name;
	}
	throw Error( file, element,
	    fmt::format( "has {} {} or more, the limit {} is {}", count, what, name, currentLimits().*limit ),
	    fmt::format( "if that is intended, raise it: --input-limit {}=N, or leeway::io::Limits", name ) );
}

} // namespace detail
} // namespace leeway::io
