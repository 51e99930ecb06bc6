// SPDX-License-Identifier: BSD-3-Clause
// Columns of arrays in the order of a group's variables.
#pragma once

#include "leeway/io/model.hpp"

#include <cstddef>
#include <string>
#include <vector>

namespace leeway::referee
{

/// For each variable of the group its column.
/// @param names of the columns; empty: the group's variables in their order @param count of columns @throws io::Error
std::vector<std::size_t> groupColumns( const io::Problem& problem, const std::vector<std::string>& names, std::size_t count,
    const std::string& file, const std::string& element );

} // namespace leeway::referee
