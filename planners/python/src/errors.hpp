// SPDX-License-Identifier: BSD-3-Clause
// Errors of the library as exceptions of Python, and enumerations.
#pragma once

#include "leeway/handles.hpp"

#include <nanobind/nanobind.h>

namespace leeway::python
{

/// Adds leeway.Error and its subclasses, and the translation of C++ exceptions into them.
void bindErrors( nanobind::module_& module );

} // namespace leeway::python
