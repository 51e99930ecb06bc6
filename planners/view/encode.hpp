// SPDX-License-Identifier: BSD-3-Clause
// Bytes and texts in the form that a page can hold.
#pragma once

#include "motions/json.hpp"

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace leeway::view
{

using motions::Json;

/// Numbers of meshes and spheres, one after the other: the page reads them as typed arrays. Each block begins at a multiple of 4.
class PageBytes
{
public:
	/// Appends a block and returns its first byte.
	template <typename T> std::size_t add( const std::vector<T>& block )
	{
		return append( block.data(), block.size() * sizeof( T ) );
	}
	const std::string& all() const { return m_bytes; }

private:
	std::size_t append( const void* data, std::size_t size );
	std::string m_bytes;
};

/// @throws io::Error if memory is too small
std::string gzip( const std::string& bytes );
std::string base64( const std::string& bytes );

/// JSON that may stand in a script element: no name in it can end the element or open a comment.
std::string jsonForScript( const Json& json );

} // namespace leeway::view
