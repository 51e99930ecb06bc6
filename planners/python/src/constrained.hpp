// SPDX-License-Identifier: BSD-3-Clause
// Checker.plan_request() and plan_sequence(), and the settings that Checker.plan_line() has too.
#pragma once

#include "objects.hpp"

#include "leeway/motions/timed.hpp"

#include <functional>

namespace leeway::python
{

/// Limits of a motion: those of the arguments; None: of the robot, for accelerations 1.
/// @throws nb::value_error for another shape, or a limit that is not above 0
motions::MotionLimits limitsOf( const PyChecker& checker, const nb::object& velocity, const nb::object& acceleration );

/// The arguments as settings, without `stop`. @throws as limitsOf()
motions::MotionSettings settingsOf( const PyChecker& checker, double min_d, double slack, const std::string& check,
    const Whole& seed, const nb::object& velocity, const nb::object& acceleration );

void bindConstrained( nb::class_<PyChecker>& type );

/// Works on another thread, while this one lets the interpreter handle signals. Ctrl-C calls `cancel`, whereupon the work has to end soon.
/// @throws nb::python_error after Ctrl-C, and all that the work throws
void workInterruptibly( const std::function<void()>& work, const std::function<void()>& cancel );

} // namespace leeway::python
