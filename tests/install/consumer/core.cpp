// SPDX-License-Identifier: BSD-3-Clause
// C++ against the installed core: the C headers and the owning handles need nothing but leeway::core.
#include <leeway/leeway.h>

int main()
{
	lw_shape* shape = nullptr;
	const double size[3] = { 0.5, 0, 0 };
	lw_status status = lw_shape_create_primitive( LW_SHAPE_SPHERE, size, nullptr, nullptr, &shape );
	bool ok = status == LW_OK && lw_shape_get_info( shape ).sphere_radius >= 0.5 && lw_version() == LW_VERSION;
	lw_shape_release( shape );
	return ok ? 0 : 1;
}
