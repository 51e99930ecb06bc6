// SPDX-License-Identifier: BSD-3-Clause
// Suggestions for misspelt names in files.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace leeway::io
{

/// Number of letters to insert, remove, replace or swap with their neighbour.
std::size_t editDistance( const std::string& a, const std::string& b );

/// The known key that an unknown key probably stands for: it differs by one letter (changed, left out, added, or two
/// neighbours swapped), by case, or by '_', '-' and blanks between words. Keys of two letters match only by case and
/// separators.
/// @return empty if no known key is that near, or if the key itself is known
std::string meantKey( const std::string& key, const std::vector<std::string>& known );

} // namespace leeway::io
