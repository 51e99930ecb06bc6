// SPDX-License-Identifier: BSD-3-Clause
// Blobs and cache files. Each input is tried as it is, and once more with size and checksum made right: else no fuzzer comes
// past the checksum, and the code behind it would go untested.
#include "fuzz.hpp"

#include "cache/cache_file.hpp"
#include "blob/blob.h"
#include "leeway/io/cache.hpp"

#include <cstring>

namespace fuzz
{

namespace
{

namespace detail = leeway::io::detail;

lw_digest keyIn( const std::string& bytes )
{
	lw_digest key{};
	if ( bytes.size() >= LWI_BLOB_KEY + sizeof key )
	{
		std::memcpy( &key, bytes.data() + LWI_BLOB_KEY, sizeof key );
	}
	return key;
}

/// The bytes as a blob whose header is about them.
std::string sealed( std::string bytes )
{
	if ( bytes.size() >= LWI_BLOB_TABLE )
	{
		const std::uint64_t size = bytes.size();
		std::memcpy( bytes.data() + LWI_BLOB_SIZE, &size, sizeof size );
		lwi_blob_seal( reinterpret_cast<unsigned char*>( bytes.data() ), bytes.size() );
	}
	return bytes;
}

void readShapes( const std::string& bytes )
{
	lw_diag diag{};
	lw_blob_info info;
	if ( lw_blob_get_info( bytes.data(), bytes.size(), &diag, &info ) != LW_OK )
	{
		expect( diag.message[0] != '\0', "a blob that is refused says why" );
		return;
	}
	std::vector<lw_shape*> shapes( info.shape_count, nullptr );
	const lw_status status =
	    lw_blob_read_shapes( bytes.data(), bytes.size(), keyIn( bytes ), nullptr, &diag, shapes.data(), info.shape_count );
	for ( lw_shape* shape : shapes )
	{
		expect( ( status == LW_OK ) == ( shape != nullptr ), "there are shapes if and only if the status is LW_OK" );
		if ( shape != nullptr )
		{
			useShape( shape );
			lw_shape_release( shape );
		}
	}
}

const lw_robot* fixedCoreRobot()
{
	static const leeway::Robot robot = leeway::io::buildRobot( fixedRobot() );
	return robot.get();
}

void readReach( const std::string& bytes )
{
	const lw_robot* robot = fixedCoreRobot();
	lw_diag diag{};
	lw_reach* reach = nullptr;
	const lw_status status = lw_blob_read_reach( bytes.data(), bytes.size(), keyIn( bytes ), robot, nullptr, &diag, &reach );
	expect( ( status == LW_OK ) == ( reach != nullptr ), "there is a reach if and only if the status is LW_OK" );
	if ( reach == nullptr )
	{
		return;
	}
	lw_checker_def def = lw_checker_def_default();
	def.robot = robot;
	def.reach = reach;
	lw_checker* checker = nullptr;
	if ( lw_checker_create( &def, nullptr, &diag, &checker ) == LW_OK )
	{
		const leeway::Query query = leeway::makeQuery( checker );
		const double q[2] = { 0.5, 0.1 };
		lw_state_result result;
		(void)lw_checker_state( checker, query.get(), q, LW_CHECK_BOTH, nullptr, false, &result );
	}
	lw_checker_release( checker );
	lw_reach_release( reach );
}

} // namespace

void shapeBlob( Input input )
{
	readShapes( std::string( input ) );
	readShapes( sealed( std::string( input ) ) );
}

void reachBlob( Input input )
{
	readReach( std::string( input ) );
	std::string bytes( input );
	// The robot's digest begins the section of a blob that holds nothing else
	const std::size_t section = LWI_BLOB_TABLE + LWI_BLOB_TABLE_ENTRY;
	const lw_digest robot = lw_robot_digest( fixedCoreRobot() );
	if ( bytes.size() >= section + sizeof robot )
	{
		std::memcpy( bytes.data() + section, robot.word, sizeof robot.word );
	}
	readReach( sealed( bytes ) );
}

void cacheFile( Input input )
{
	const lw_digest key{ { 1, 2 } };
	const std::string file = put( "input-00000000000000010000000000000002.tree", input );
	std::vector<leeway::io::Notice> notices;
	const bool used = detail::readCacheFile( file, key, notices,
	    []( detail::CacheFile& content, lw_diag& )
	    {
		    readShapes( content.blob );
		    return content.blob.empty() ? LW_ERROR_DAMAGED : LW_OK;
	    } );
	expect( used || !notices.empty(), "a cache file that is not used is a notice" );
	for ( const leeway::io::CacheEntry& entry : leeway::io::listCache( pathOf( "" ) ) )
	{
		expect( entry.kind != leeway::io::CacheEntry::tree || entry.good || !entry.problem.empty(), "what is bad says why" );
	}
}

} // namespace fuzz
