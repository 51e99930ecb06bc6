// SPDX-License-Identifier: BSD-3-Clause
// A library for LD_PRELOAD that refuses every change of a file outside of the stated places, and notes it:
//
//   LEEWAY_GUARD_WRITES  folders and files that may be written, made, renamed and removed; a ':' between them. A file may
//                        have a name of its own beside it ("out.csv.partial-AbCdEf"), as results are replaced in one step
//   LEEWAY_GUARD_READS   folders and files that may be read; unset: all
//   LEEWAY_GUARD_LOG     file to which each refused call is appended: the call, a blank, the path
//
// Paths are made absolute and freed of "." and "..", not of links: the tests compare real paths. Sockets are refused too, and
// programs that are started unless LEEWAY_GUARD_WRITES names them. Calls that the C library makes inside of itself are not
// seen, hence fopen(), mkstemp() and their kind stand here beside open().
#define _GNU_SOURCE
// The macros turn each of these into its twin for large files
#undef _FILE_OFFSET_BITS
#undef _FORTIFY_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/time.h>
#include <unistd.h>

#define PUBLIC __attribute__( ( visibility( "default" ) ) )

/// The function that would have been called without this library.
static void* next( const char* name )
{
	void* found = dlsym( RTLD_NEXT, name );
	if ( found == NULL )
	{
		abort();
	}
	return found;
}

#define NEXT( type, name ) ( (type)next( #name ) )

/// The path as an absolute one without "." and "..". @return false if it does not fit
static bool full_path( int folder, const char* path, char out[PATH_MAX] )
{
	char joined[2 * PATH_MAX];
	joined[0] = '\0';
	if ( path[0] != '/' && folder == AT_FDCWD )
	{
		if ( getcwd( joined, PATH_MAX ) == NULL )
		{
			return false;
		}
	}
	else if ( path[0] != '/' )
	{
		char link[64];
		snprintf( link, sizeof( link ), "/proc/self/fd/%d", folder );
		const ssize_t length = readlink( link, joined, PATH_MAX - 1 );
		if ( length < 0 )
		{
			return false;
		}
		joined[length] = '\0';
	}
	const size_t used = strlen( joined );
	if ( used + 1 + strlen( path ) >= sizeof( joined ) )
	{
		return false;
	}
	joined[used] = '/';
	strcpy( joined + used + 1, path );
	size_t end = 0;
	char* rest = NULL;
	for ( char* part = strtok_r( joined, "/", &rest ); part != NULL; part = strtok_r( NULL, "/", &rest ) )
	{
		if ( strcmp( part, ".." ) == 0 )
		{
			while ( end > 0 && out[--end] != '/' )
			{
			}
		}
		else if ( strcmp( part, "." ) != 0 )
		{
			const size_t length = strlen( part );
			if ( end + length + 2 > PATH_MAX )
			{
				return false;
			}
			out[end] = '/';
			memcpy( out + end + 1, part, length );
			end += length + 1;
		}
	}
	out[end] = '\0';
	return true;
}

/// @param places a list with ':' between
static bool is_in( const char* path, const char* places )
{
	for ( const char* at = places; *at != '\0'; )
	{
		const size_t length = strcspn( at, ":" );
		if ( length > 0 && strncmp( path, at, length ) == 0 )
		{
			const char* more = path + length;
			if ( *more == '\0' || *more == '/' || at[length - 1] == '/' || strncmp( more, ".partial-", 9 ) == 0 )
			{
				return true;
			}
		}
		at += length + ( at[length] == ':' );
	}
	return false;
}

static void note( const char* call, const char* path )
{
	const char* log = getenv( "LEEWAY_GUARD_LOG" );
	char line[PATH_MAX + 64];
	const int length = snprintf( line, sizeof( line ), "%s %s\n", call, path );
	const long file =
	    log != NULL ? syscall( SYS_openat, AT_FDCWD, log, O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666 ) : -1;
	if ( file >= 0 && length > 0 )
	{
		const size_t size = (size_t)length < sizeof( line ) ? (size_t)length : sizeof( line ) - 1;
		(void)syscall( SYS_write, (int)file, line, size );
		(void)syscall( SYS_close, (int)file );
	}
}

/// @return true if the call may go on; else it is noted, and errno is EPERM
static bool allowed( const char* call, int folder, const char* path, const char* variable )
{
	const char* places = getenv( variable );
	char full[PATH_MAX];
	if ( path == NULL || places == NULL || ( full_path( folder, path, full ) && is_in( full, places ) ) )
	{
		return true;
	}
	note( call, path[0] == '/' || !full_path( folder, path, full ) ? path : full );
	errno = EPERM;
	return false;
}

static bool may_write( const char* call, int folder, const char* path )
{
	return allowed( call, folder, path, "LEEWAY_GUARD_WRITES" );
}

static bool may_open( const char* call, int folder, const char* path, int flags )
{
	const bool writes = ( flags & O_ACCMODE ) != O_RDONLY || ( flags & ( O_CREAT | O_TRUNC | O_APPEND ) ) != 0;
	return writes ? may_write( call, folder, path ) : allowed( call, folder, path, "LEEWAY_GUARD_READS" );
}

static bool may_fopen( const char* call, const char* path, const char* mode )
{
	return may_open( call, AT_FDCWD, path, strpbrk( mode, "wa+" ) != NULL ? O_WRONLY : O_RDONLY );
}

// ---- files that are opened

#define GUARD_OPEN( name )                                                                                                  \
	PUBLIC int name( const char* path, int flags, ... )                                                                     \
	{                                                                                                                       \
		va_list more;                                                                                                       \
		va_start( more, flags );                                                                                            \
		const mode_t mode = ( flags & ( O_CREAT | O_TMPFILE ) ) != 0 ? va_arg( more, mode_t ) : 0;                          \
		va_end( more );                                                                                                     \
		return may_open( #name, AT_FDCWD, path, flags )                                                                     \
		           ? NEXT( int ( * )( const char*, int, ... ), name )( path, flags, mode )                                  \
		           : -1;                                                                                                    \
	}

#define GUARD_OPENAT( name )                                                                                                \
	PUBLIC int name( int folder, const char* path, int flags, ... )                                                         \
	{                                                                                                                       \
		va_list more;                                                                                                       \
		va_start( more, flags );                                                                                            \
		const mode_t mode = ( flags & ( O_CREAT | O_TMPFILE ) ) != 0 ? va_arg( more, mode_t ) : 0;                          \
		va_end( more );                                                                                                     \
		return may_open( #name, folder, path, flags )                                                                       \
		           ? NEXT( int ( * )( int, const char*, int, ... ), name )( folder, path, flags, mode )                     \
		           : -1;                                                                                                    \
	}

#define GUARD_FOPEN( name )                                                                                                 \
	PUBLIC FILE* name( const char* path, const char* mode )                                                                 \
	{                                                                                                                       \
		return may_fopen( #name, path, mode ) ? NEXT( FILE * (*)(const char*, const char*), name )( path, mode ) : NULL;    \
	}

#define GUARD_FREOPEN( name )                                                                                               \
	PUBLIC FILE* name( const char* path, const char* mode, FILE* stream )                                                   \
	{                                                                                                                       \
		return path == NULL || may_fopen( #name, path, mode )                                                               \
		           ? NEXT( FILE * (*)(const char*, const char*, FILE*), name )( path, mode, stream )                        \
		           : NULL;                                                                                                  \
	}

GUARD_OPEN( open )
GUARD_OPEN( open64 )
GUARD_OPENAT( openat )
GUARD_OPENAT( openat64 )
GUARD_FOPEN( fopen )
GUARD_FOPEN( fopen64 )
GUARD_FREOPEN( freopen )
GUARD_FREOPEN( freopen64 )

/// As compiled with _FORTIFY_SOURCE.
PUBLIC int __open_2( const char* path, int flags )
{
	return open( path, flags );
}
PUBLIC int __open64_2( const char* path, int flags )
{
	return open( path, flags );
}
PUBLIC int __openat_2( int folder, const char* path, int flags )
{
	return openat( folder, path, flags );
}
PUBLIC int __openat64_2( int folder, const char* path, int flags )
{
	return openat( folder, path, flags );
}

// ---- calls with one path that change something

#define GUARD_ONE( result, name, bad, parameters, arguments, folder, path )                                                 \
	PUBLIC result name parameters                                                                                           \
	{                                                                                                                       \
		return may_write( #name, folder, path ) ? NEXT( result( * ) parameters, name ) arguments : bad;                     \
	}

GUARD_ONE( int, creat, -1, ( const char* path, mode_t mode ), ( path, mode ), AT_FDCWD, path )
GUARD_ONE( int, creat64, -1, ( const char* path, mode_t mode ), ( path, mode ), AT_FDCWD, path )
GUARD_ONE( int, unlink, -1, ( const char* path ), ( path ), AT_FDCWD, path )
GUARD_ONE( int, unlinkat, -1, ( int folder, const char* path, int flags ), ( folder, path, flags ), folder, path )
GUARD_ONE( int, remove, -1, ( const char* path ), ( path ), AT_FDCWD, path )
GUARD_ONE( int, rmdir, -1, ( const char* path ), ( path ), AT_FDCWD, path )
GUARD_ONE( int, mkdir, -1, ( const char* path, mode_t mode ), ( path, mode ), AT_FDCWD, path )
GUARD_ONE( int, mkdirat, -1, ( int folder, const char* path, mode_t mode ), ( folder, path, mode ), folder, path )
GUARD_ONE( int, mkfifo, -1, ( const char* path, mode_t mode ), ( path, mode ), AT_FDCWD, path )
GUARD_ONE( int, mkfifoat, -1, ( int folder, const char* path, mode_t mode ), ( folder, path, mode ), folder, path )
GUARD_ONE( int, mknod, -1, ( const char* path, mode_t mode, dev_t device ), ( path, mode, device ), AT_FDCWD, path )
GUARD_ONE( int, mknodat, -1, ( int folder, const char* path, mode_t mode, dev_t device ), ( folder, path, mode, device ),
    folder, path )
GUARD_ONE( int, symlink, -1, ( const char* target, const char* path ), ( target, path ), AT_FDCWD, path )
GUARD_ONE( int, symlinkat, -1, ( const char* target, int folder, const char* path ), ( target, folder, path ), folder, path )
GUARD_ONE( int, truncate, -1, ( const char* path, off_t size ), ( path, size ), AT_FDCWD, path )
GUARD_ONE( int, truncate64, -1, ( const char* path, off64_t size ), ( path, size ), AT_FDCWD, path )
GUARD_ONE( int, chmod, -1, ( const char* path, mode_t mode ), ( path, mode ), AT_FDCWD, path )
GUARD_ONE( int, fchmodat, -1, ( int folder, const char* path, mode_t mode, int flags ), ( folder, path, mode, flags ),
    folder, path )
GUARD_ONE( int, chown, -1, ( const char* path, uid_t user, gid_t group ), ( path, user, group ), AT_FDCWD, path )
GUARD_ONE( int, lchown, -1, ( const char* path, uid_t user, gid_t group ), ( path, user, group ), AT_FDCWD, path )
GUARD_ONE( int, utimes, -1, ( const char* path, const struct timeval times[2] ), ( path, times ), AT_FDCWD, path )
GUARD_ONE( int, utimensat, -1, ( int folder, const char* path, const struct timespec times[2], int flags ),
    ( folder, path, times, flags ), folder, path )
GUARD_ONE( int, mkstemp, -1, ( char* path ), ( path ), AT_FDCWD, path )
GUARD_ONE( int, mkstemp64, -1, ( char* path ), ( path ), AT_FDCWD, path )
GUARD_ONE( int, mkostemp, -1, ( char* path, int flags ), ( path, flags ), AT_FDCWD, path )
GUARD_ONE( int, mkostemp64, -1, ( char* path, int flags ), ( path, flags ), AT_FDCWD, path )
GUARD_ONE( int, mkstemps, -1, ( char* path, int ending ), ( path, ending ), AT_FDCWD, path )
GUARD_ONE( int, mkstemps64, -1, ( char* path, int ending ), ( path, ending ), AT_FDCWD, path )
GUARD_ONE( char*, mkdtemp, NULL, ( char* path ), ( path ), AT_FDCWD, path )
GUARD_ONE( FILE*, tmpfile, NULL, (void), (), AT_FDCWD, "/tmp/tmpfile" )
GUARD_ONE( FILE*, tmpfile64, NULL, (void), (), AT_FDCWD, "/tmp/tmpfile" )
GUARD_ONE( int, execve, -1, ( const char* path, char* const* words, char* const* variables ), ( path, words, variables ),
    AT_FDCWD, path )
GUARD_ONE( int, execv, -1, ( const char* path, char* const* words ), ( path, words ), AT_FDCWD, path )
GUARD_ONE( int, execvp, -1, ( const char* path, char* const* words ), ( path, words ), AT_FDCWD, path )
GUARD_ONE( int, system, -1, ( const char* command ), ( command ), AT_FDCWD, command )
GUARD_ONE( FILE*, popen, NULL, ( const char* command, const char* mode ), ( command, mode ), AT_FDCWD, command )

// ---- calls with two: both ends change

PUBLIC int rename( const char* from, const char* to )
{
	return may_write( "rename", AT_FDCWD, from ) && may_write( "rename", AT_FDCWD, to )
	           ? NEXT( int ( * )( const char*, const char* ), rename )( from, to )
	           : -1;
}

PUBLIC int renameat( int from_folder, const char* from, int to_folder, const char* to )
{
	return may_write( "renameat", from_folder, from ) && may_write( "renameat", to_folder, to )
	           ? NEXT( int ( * )( int, const char*, int, const char* ), renameat )( from_folder, from, to_folder, to )
	           : -1;
}

PUBLIC int renameat2( int from_folder, const char* from, int to_folder, const char* to, unsigned flags )
{
	return may_write( "renameat2", from_folder, from ) && may_write( "renameat2", to_folder, to )
	           ? NEXT( int ( * )( int, const char*, int, const char*, unsigned ), renameat2 )(
	                 from_folder, from, to_folder, to, flags )
	           : -1;
}

PUBLIC int link( const char* from, const char* to )
{
	return may_write( "link", AT_FDCWD, to ) ? NEXT( int ( * )( const char*, const char* ), link )( from, to ) : -1;
}

PUBLIC int linkat( int from_folder, const char* from, int to_folder, const char* to, int flags )
{
	return may_write( "linkat", to_folder, to ) ? NEXT( int ( * )( int, const char*, int, const char*, int ), linkat )(
	                                                  from_folder, from, to_folder, to, flags )
	                                            : -1;
}

// ---- the network

PUBLIC int socket( int domain, int type, int protocol )
{
	(void)domain, (void)type, (void)protocol;
	note( "socket", "network" );
	errno = EPERM;
	return -1;
}
