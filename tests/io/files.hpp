// SPDX-License-Identifier: BSD-3-Clause
// A folder of small model files, written by a test and removed with it, and checks of errors and notices.
#pragma once

#include "leeway/io/model.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

/// A fresh folder per test; package environments of the machine do not reach into it.
class FileTest : public testing::Test
{
protected:
	FileTest()
	{
		unsetenv( "ROS_PACKAGE_PATH" );
		unsetenv( "AMENT_PREFIX_PATH" );
		std::string pattern = ( std::filesystem::temp_directory_path() / "leeway_io_XXXXXX" ).string();
		m_folder = mkdtemp( pattern.data() );
	}
	~FileTest() override
	{
		std::error_code error;
		std::filesystem::remove_all( m_folder, error );
	}
	std::string path( const std::string& name ) const { return ( m_folder / name ).string(); }
	std::string write( const std::string& name, const std::string& content ) const
	{
		std::filesystem::create_directories( ( m_folder / name ).parent_path() );
		std::ofstream( m_folder / name, std::ios::binary ) << content;
		return path( name );
	}
	/// A tetrahedron with corners 0, x, y, z of the given size.
	std::string writeTetrahedron( const std::string& name, double size = 1 ) const
	{
		std::string s = std::to_string( size );
		return write(
		    name, "v 0 0 0\nv " + s + " 0 0\nv 0 " + s + " 0\nv 0 0 " + s + "\nf 1 2 3\nf 1 2 4\nf 1 3 4\nf 2 3 4\n" );
	}

private:
	std::filesystem::path m_folder;
};

/// The call throws an io::Error whose text has every one of these parts, and a remedy.
template <typename F> void expectError( F call, const std::vector<std::string>& parts )
{
	try
	{
		call();
		ADD_FAILURE() << "no error; expected one with \"" << ( parts.empty() ? "" : parts[0] ) << "\"";
	}
	catch ( const leeway::io::Error& error )
	{
		std::string text = error.what();
		for ( const std::string& part : parts )
		{
			EXPECT_NE( text.find( part ), std::string::npos ) << "\"" << part << "\" is not in: " << text;
		}
		EXPECT_FALSE( error.remedy().empty() ) << text;
		EXPECT_FALSE( error.file().empty() ) << text;
		EXPECT_EQ( text.find( '\n' ), std::string::npos ) << text;
	}
}

inline bool hasNotice( const std::vector<leeway::io::Notice>& notices, const std::string& part )
{
	for ( const leeway::io::Notice& notice : notices )
	{
		if ( ( notice.element + ": " + notice.text ).find( part ) != std::string::npos )
		{
			return true;
		}
	}
	return false;
}

inline std::string allNotices( const std::vector<leeway::io::Notice>& notices )
{
	std::string text;
	for ( const leeway::io::Notice& notice : notices )
	{
		text += notice.element + ": " + notice.text + "\n";
	}
	return text;
}

#define EXPECT_NOTICE( notices, part ) EXPECT_TRUE( hasNotice( notices, part ) ) << allNotices( notices )

inline void expectPoint( const lw_transform& pose, double x, double y, double z )
{
	EXPECT_NEAR( pose.t[0], x, 1e-12 );
	EXPECT_NEAR( pose.t[1], y, 1e-12 );
	EXPECT_NEAR( pose.t[2], z, 1e-12 );
}
