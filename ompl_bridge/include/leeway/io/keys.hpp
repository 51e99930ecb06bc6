// SPDX-License-Identifier: BSD-3-Clause
// Suggestions for misspelt names in files.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace YAML
{
class Node;
}

namespace leeway::io
{

/// Refuses keys that a map of a YAML or JSON document has twice (readers differ in which one counts), merge keys, and documents that contain themselves or
/// are far larger than their text by aliases. @param text_size of the document @param first_line of the file, from 0, that the document begins at
/// @throws Error with the key and both lines
void requireSoundDocument(
    const std::string& file, const YAML::Node& root, std::size_t text_size, std::size_t first_line = 0 );

/// Are there two YAML documents or more in the text, or two values of JSON? YAML::Load() reads the first and leaves out the rest.
bool holdsSeveralDocuments( const std::string& text );

/// Is a value of a message empty: null, false, 0, an empty text, a list of such scalars, a map of such values?
bool saysNothing( const YAML::Node& value );

/// Number of letters to insert, remove, replace or swap with their neighbour.
std::size_t editDistance( const std::string& a, const std::string& b );

/// The known key that an unknown key probably stands for: it differs by one letter (changed, left out, added, or two
/// neighbours swapped), by case, or by '_', '-' and blanks between words. Keys of two letters match only by case and
/// separators.
/// @return empty if no known key is that near, or if the key itself is known
std::string meantKey( const std::string& key, const std::vector<std::string>& known );

} // namespace leeway::io
