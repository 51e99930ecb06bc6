// SPDX-License-Identifier: BSD-3-Clause
// Point cloud files: PCD (ascii, binary, binary_compressed) and PLY (ascii, binary of both byte orders).
#pragma once

#include "base/binary_data.hpp"

namespace leeway::io::detail
{

struct PointCloud
{
	std::vector<double> points;     ///< x, y, z, ... as in the file
	std::size_t dropped = 0;        ///< points with a coordinate that is not finite: a sensor saw nothing there
	std::vector<std::string> notes; ///< about parts of the file that a shape cannot represent

	/// Keeps the point, or counts it as dropped.
	void add( double x, double y, double z );
};

/// Reads a .pcd or .ply file. Memory grows with the bytes of the file, never with the sizes that its header states.
/// @throws Error with the cloud's file and the place in it
PointCloud readPointCloud( const std::string& file );

/// Base class of the readers of both formats.
class CloudReader
{
protected:
	/// @throws Error if the file cannot be read
	explicit CloudReader( const std::string& file );
	/// Of bytes that were read already. @param name for errors
	CloudReader( const std::string& name, std::string bytes );
	[[noreturn]] void fail( const std::string& place, const std::string& problem, const std::string& remedy ) const;
	/// The words of the next line of the header that has some and is no comment; an empty optional at the end of the file.
	/// @param is_comment of a line's first word
	/// @throws Error if the line is no text: it must not get into an error's line
	std::optional<std::vector<std::string>> headerLine( bool ( *is_comment )( const std::string& ) );
	/// "header line 7", of the last one.
	std::string headerPlace() const;

	std::string m_file, m_text;
	ByteReader m_bytes;
	std::size_t m_line = 0;
	PointCloud m_cloud;
};

PointCloud readPcd( const std::string& file );
PointCloud readPlyPoints( const std::string& file );

} // namespace leeway::io::detail
