// SPDX-License-Identifier: BSD-3-Clause
// A mesh between its file and its tree: looked at when it is loaded, built when a query needs it.
#pragma once

#include "cache/cache_file.hpp"

#include <atomic>
#include <memory>
#include <mutex>

namespace leeway::io::detail
{

/// A mesh as its user gets it.
struct OpenedMesh
{
	Shape shape; ///< deferred, unless the options say otherwise
	std::size_t dropped_faces = 0;
	bool cached = false;                              ///< its tree comes, or will come, from the cache
	double milliseconds = 0;                          ///< of the first pass, and of the second if that came at once
	double cache_milliseconds = 0;                    ///< of these: looking into the cache
	std::shared_ptr<const std::atomic<double>> built; ///< milliseconds of the second pass; negative until then
};

/// One mesh file at one scale.
///
/// The first pass reads the file, and finds its box and its defects: open() reports every defect that a mesh can have.
/// Binary STL needs only its numbers for that; other formats are parsed. The source data stays in memory, so that a later
/// change of the file has no effect. A deferred shape keeps its source alive.
class MeshSource : public std::enable_shared_from_this<MeshSource>
{
public:
	/// @throws Error with `from_file` and `element`
	static OpenedMesh open( const LoadOptions& options, const std::string& file, const std::array<double, 3>& scale,
	    const std::string& from_file, const std::string& element, std::vector<Notice>& notices );

private:
	explicit MeshSource( const LoadOptions& options ) : m_options( options ) {}
	void look( const std::string& from_file, const std::string& element, std::vector<Notice>& notices );
	bool readCache( std::vector<Notice>& notices );
	bool findBox();
	void widenBox();
	lw_status build( lw_diag* diag, lw_shape** out );
	lw_status make( lw_diag* diag, lw_shape** out );
	void save( const lw_shape* shape );
	Shape deferredShape();
	Shape shapeNow( const std::string& from_file, const std::string& element );
	static lw_status makeShape( void* user, lw_diag* diag, lw_shape** out );
	static void release( void* user );

	LoadOptions m_options;
	std::string m_file;
	std::array<double, 3> m_scale{};
	std::size_t m_dropped_faces = 0;
	bool m_cached = false, m_usable = false;
	double m_cache_milliseconds = 0;
	lw_deferred_def m_def = lw_deferred_def_default();
	std::shared_ptr<std::atomic<double>> m_built = std::make_shared<std::atomic<double>>( -1 );

	// The source data, until the shape is made
	std::mutex m_mutex;
	std::string m_stl;   ///< bytes of a binary STL file
	TriangleSoup m_soup; ///< of any other
	std::string m_blob;  ///< of the cache
	std::string m_cache_file;
	lw_digest m_key{};
	Shape m_made; ///< for a second thread that came at the same time
};

} // namespace leeway::io::detail
