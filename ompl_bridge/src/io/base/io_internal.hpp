// SPDX-License-Identifier: BSD-3-Clause
// Shared by all readers: text and numbers, package paths, mesh files, shapes built once per file and scale.
#pragma once

#include "leeway/io/limits.hpp"
#include "leeway/io/model.hpp"

#include <array>
#include <chrono>
#include <cstring>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

namespace leeway::io::detail
{

class XmlFile;

constexpr double pi = 3.14159265358979323846;

/// A quaternion whose length differs from 1 by more than this is worth a notice: 0.707 written for sqrt(1/2) gives 1.5e-4
/// and turns nothing once normalised; more than 1e-3 is no rounding of a writer.
constexpr double quaternion_notice_threshold = 1e-3;

/// Names go into reports that have to be UTF-8.
bool isUtf8( std::string_view text );

/// ASCII letters in lower case; all other bytes as they are.
std::string lower( std::string text );

/// The bytes of a regular file: for names that stand in other files, and so lead to no stream of the program.
/// @throws Error as readWholeFile()
std::string readFile( const std::string& file );

/// "a folder", "a pipe", "a socket" or "a device"; empty for a regular file, and for a path with nothing there.
std::string fileKind( const std::string& file );

/// A decimal number that is the whole of `text` (blanks around it aside), in any locale; "nan" and "inf" are numbers here,
/// so that a caller can tell "not a number at all" from "not finite".
std::optional<double> parseNumber( std::string_view text );

std::vector<std::string> splitBlanks( std::string_view text );

/// "a, b, c"; at most `limit` of them, then "... (12 in all)".
std::string joinNames( const std::vector<std::string>& names, std::size_t limit = 20 );

/// The file that a URI of `from_file` names: package://, file://, absolute, or relative to the folder of `from_file`.
/// @param kind "point cloud", for the error
/// @param notices receives one for each package whose folder was guessed
/// @throws Error with `from_file` and `element` and every path that was tried, in order
std::string findResource( const char* kind, const std::string& uri, const std::string& from_file, const std::string& element,
    const LoadOptions& options, std::vector<Notice>& notices );

/// Whether findResource() would find a file.
bool hasResource( const std::string& uri, const std::string& from_file, const LoadOptions& options );

/// Wall time since it was made.
class Stopwatch
{
public:
	double milliseconds() const
	{
		return std::chrono::duration<double, std::milli>( std::chrono::steady_clock::now() - m_start ).count();
	}

private:
	std::chrono::steady_clock::time_point m_start = std::chrono::steady_clock::now();
};

/// Triangles of a mesh file, all nodes' transforms applied; nothing merged or removed.
struct TriangleSoup
{
	std::vector<double> vertices;       ///< x, y, z, ...
	std::vector<std::uint32_t> indices; ///< three per triangle
	std::size_t dropped_faces = 0;      ///< points and lines: they have no surface
};

/// @param element the place in `from_file` that names the mesh file, for errors
/// @throws Error with `from_file` and `element` if the file cannot be read as a mesh, or is beyond a limit
/// @param bytes of the file, if the caller has read it already (moved from); else empty
TriangleSoup readMeshFile(
    const std::string& mesh_file, const std::string& from_file, const std::string& element, std::string bytes = {} );

/// True if all triangles are in the one file, so that its bytes determine the mesh. (The text form of glTF keeps them in other
/// files, the binary form may.)
bool isSelfContained( const std::string& extension, std::string_view bytes );

/// ".stl" for "arm.STL"
std::string lowerExtension( const std::string& file );

/// True for the bytes of a binary STL file with at least one triangle.
bool isBinaryStl( const std::string& bytes );

/// Calls f( const float[9] ) with the corners of each triangle of a binary STL file. @return how many there were
template <typename F> std::uint32_t forEachStlTriangle( const std::string& bytes, F f )
{
	constexpr std::size_t header = 84, record = 50, normal = 12;
	std::uint32_t count = 0;
	for ( std::size_t at = header; at + record <= bytes.size(); at += record, ++count )
	{
		float corners[9];
		std::memcpy( corners, bytes.data() + at + normal, sizeof( corners ) );
		f( corners );
	}
	return count;
}

/// Appends the report of another file's reader.
void append( const LoadReport& report, LoadReport& out );

/// A mesh file, by device and number of its inode, at one scale.
using MeshKey = std::tuple<std::string, double, double, double>;
/// Two URIs may be one file, and the same file may be reached through a link.
MeshKey meshKey( const std::string& file, const std::array<double, 3>& scale );

/// A shape as the options want it: the coarser one of LoadOptions::detail, or itself.
/// @param shape a reference that is passed on, or dropped on failure
lw_status atDetail( const LoadOptions& options, lw_diag* diag, lw_shape** shape );

/// Builds core shapes during one load; a mesh file used several times at one scale becomes one shape.
class ShapeLoader
{
public:
	/// @throws Error if there is to be a cache and its folder cannot be made, or LoadOptions::detail is no tolerance
	ShapeLoader( const LoadOptions& options, LoadReport& report );

	/// The place that names a shape: the file, the element for errors, and the link or object that owns the shape.
	struct Place
	{
		std::string file, element, owner;
	};

	Shape mesh( const Place& place, const std::string& uri, const std::array<double, 3>& scale );
	Shape inlineMesh( const Place& place, const TriangleSoup& soup );
	Shape primitive( const Place& place, lw_shape_type type, const std::array<double, 3>& dimensions );

private:
	/// A mesh that was opened before, and its count of dropped faces for the report.
	struct Known
	{
		Shape shape;
		std::size_t dropped_faces = 0;
	};

	const LoadOptions& m_options;
	LoadReport& m_report;
	std::map<MeshKey, Known> m_meshes;
};

/// A URDF without SRDF, or an MJCF: told apart by the root element.
RobotModel readRobot( std::unique_ptr<XmlFile> xml, const LoadOptions& options );

/// io::loadRobot() for a file of one robot, which is no world. @param content of the file @throws Error
RobotModel loadOneRobot(
    const std::string& file, std::string content, const std::string& srdf_file, const LoadOptions& options );

/// Adds groups, allowed pairs, virtual joint and states of an SRDF to a model.
/// @param strict as LoadOptions::strict
void readSrdf( const std::string& srdf_file, bool strict, RobotModel& model );

/// A half-space or plane. A link that is fixed to the root may have one: the core knows it as an obstacle, not as part of a robot.
inline bool isUnbounded( const PlacedShape& placed )
{
	const lw_shape_type type = lw_shape_peek_info( placed.shape.get() ).type;
	return type == LW_SHAPE_HALFSPACE || type == LW_SHAPE_PLANE;
}

/// The core's robot for a model. @param allowed names of links whose contact is allowed @throws Error
Robot createRobot( const RobotModel& model, const std::vector<std::pair<std::string, std::string>>& allowed );

} // namespace leeway::io::detail
