// SPDX-License-Identifier: BSD-3-Clause
// Misspelt names in files.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace leeway::io
{

/// Letters to insert, remove, replace or swap with their neighbour.
std::size_t editDistance( const std::string& a, const std::string& b );

/// The known key that an unknown one was meant to be: it differs by one letter (changed, left out, added, or two neighbours
/// swapped), by case, or by '_', '-' and blanks between words. Keys of two letters are told apart by their letters.
/// @return empty if none is that near, or the key is known itself
std::string meantKey( const std::string& key, const std::vector<std::string>& known );

} // namespace leeway::io
