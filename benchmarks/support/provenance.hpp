// SPDX-License-Identifier: BSD-3-Clause
// Provenance of figures: the header of every result file.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

/// FNV-1a, 64 bits: hashes of data and answers. Not for secrets, only to tell one from another.
class Hash
{
public:
	void add( const void* bytes, std::size_t count );
	void add( std::int64_t value ) { add( &value, sizeof value ); }
	std::string text() const;

private:
	std::uint64_t m_state = 14695981039346656037ull;
};

/// Hash over the contents of files, in the order given.
/// @throws std::runtime_error if one cannot be read
std::string hashFiles( const std::vector<std::string>& files );

/// Commit and state of the sources ("unknown" without git), compiler and flags, processor and its frequency governor, SIMD
/// level, library versions, date.
nlohmann::ordered_json provenance();

/// @throws std::runtime_error that names the file if not all of it can be written
void writeFile( const std::string& file, const std::string& text );
