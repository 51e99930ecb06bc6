// SPDX-License-Identifier: BSD-3-Clause
// Arrays of joint values: NumPy's files, and text.
#pragma once

#include <string>
#include <vector>

namespace leeway::referee
{

/// [paths][points][joints] of a .npy file of version 1 to 3 with float64 or float32, two or three dimensions, in C's or Fortran's order.
/// @throws io::Error
std::vector<std::vector<std::vector<double>>> readNpy( const std::string& file );

/// One path: a line of numbers, parted by blanks or commas, for each point; blank lines and lines with # are passed over. @throws io::Error
std::vector<std::vector<std::vector<double>>> readMatrix( const std::string& file );

} // namespace leeway::referee
