// SPDX-License-Identifier: BSD-3-Clause
// Pieces of an object's motion, as the file gives them.
#pragma once

#include "base/yaml.hpp"
#include "world/object_chain.hpp"

namespace leeway::io::detail
{

/// Appends the list `motion` of an object, and makes a loop of it by `repeat`. @throws Error
void readMotion( const YamlNode& object, ObjectChain& chain );

} // namespace leeway::io::detail
