#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# The parts of the core's binary. All findings are told, then the status is 1.
#
#   check.sh LIBRARY.so LIBRARY.a BUILD PREFIX HULLS
#
# LIBRARY.a may be the shared library itself; BUILD is installed into PREFIX, and its library has to be the same.
set -euo pipefail
export LC_ALL=C
shared=$1 archive=$2 build=$3 prefix=$4 hulls=$5
readelf=${READELF:-readelf} nm=${NM:-nm} size=${SIZE:-size} cmake=${CMAKE:-cmake}
bad=0

# report RULE LINES: each line is a finding
report()
{
	if [ -n "$2" ]; then
		printf '%s:\n' "$1"
		sed 's/^/    /' <<<"$2"
		bad=1
	fi
}

# ---- exports: lw_ and nothing else -------------------------------------------------------------------------------------
exported=$( "$nm" -D --defined-only "$shared" | awk '{ print $NF }' )
[ "$( grep -c '^lw_' <<<"$exported" )" -gt 100 ] || report "exports" "fewer than a hundred functions begin with lw_"
report "exported, but not lw_" "$( grep -v '^lw_' <<<"$exported" || true )"

# ---- writable memory of its own: none ----------------------------------------------------------------------------------
# .data.rel.ro is read-only once the loader has put addresses into it. In the archive there is nothing but our code:
case "$archive" in
*.a) report "writable globals" \
	"$( "$size" -A "$archive" | awk '/:$/ || /^[^ ]+ +:$/ { member = $1 } $1 ~ /^\.(data|bss|tdata|tbss)(\.|$)/ && $1 !~ /^\.data\.rel\.ro/ && $2 > 0 { print member, $1, $2 }' )" ;;
esac
# In the shared library there is the toolchain's, too: __dso_handle (.data) and completed.0 (.bss) of crtbeginS.o, and from libgcc
# __cpu_model and __cpu_features2, written once when the library is loaded: by them __builtin_cpu_supports() chooses kernels.
report "writable globals of the shared library" \
	"$( "$readelf" -sW "$shared" | awk '$4 == "OBJECT" || $4 == "TLS" { print $7, $3, $8 }' |
		awk -v sections="$( "$readelf" -SW "$shared" | sed -nE 's/^ *\[ *([0-9]+)\] (\.data|\.bss|\.tdata|\.tbss) .*/\1/p' | tr '\n' ' ' )" \
			'BEGIN { split( sections, list, " " ); for ( i in list ) writable[list[i]] = 1 }
			writable[$1] && $3 !~ /^(__dso_handle|completed\.[0-9]+|__TMC_END__|__cpu_model|__cpu_features2?)(@|$)/ { print $3, $2, "bytes" }' )"
while read -r name bytes; do
	most=0
	case "$name" in .data) most=16 ;; .bss) most=64 ;; esac
	[ $(( 16#$bytes )) -le "$most" ] || report "sections larger than the toolchain's own" "$name has $(( 16#$bytes )) bytes"
done < <( "$readelf" -SW "$shared" | sed -nE 's/^ *\[ *[0-9]+\] (\.data|\.bss|\.tdata|\.tbss) +[A-Z]+ +[0-9a-f]+ [0-9a-f]+ ([0-9a-f]+) .*/\1 \2/p' )

# ---- no executable stack, no text relocations --------------------------------------------------------------------------
report "stack" "$( "$readelf" -lW "$shared" | awk '/GNU_STACK/ { found = 1; if ( $7 ~ /E/ ) print "is executable:", $0 } END { if ( !found ) print "nothing is said of it: executable by default" }' )"
report "text relocations" "$( "$readelf" -dW "$shared" | grep TEXTREL || true )"

# ---- imports: this list, and nothing that ends the process or prints ----------------------------------------------------
# strtol and getenv: LW_CPU_MASK. clock_gettime: the time budget of proofs. fopen, tmpfile, fclose: the stream that qhull wants for
# its errors, /dev/null where there is one. malloc's kin only in the default allocator, and madvise: large pages. bcmp: clang's form of memcmp() == 0.
allowed='__cxa_finalize __gmon_start__ _ITM_deregisterTMCloneTable _ITM_registerTMCloneTable __stack_chk_fail __cpu_indicator_init
aligned_alloc madvise bcmp free memcmp memcpy memmove memset qsort snprintf vsnprintf strcmp strlen strncmp strchr strtol __isoc23_strtol getenv
clock_gettime acos asin atan atan2 cos sin sincos tan exp2 log2 log exp pow floor ceil trunc rint round nearbyint fmod fmax fmaxf fmin fminf
hypot cbrt ilogb ldexp scalbn frexp logb nextafter nextafterf remainder sqrt sqrtf fabs fma lrint lround copysign
__memcpy_chk __memset_chk __memmove_chk __snprintf_chk __vsnprintf_chk'
if [ "$hulls" = ON ]; then
	allowed+=' fopen fclose tmpfile qh_freeqhull qh_memfreeshort qh_new_qhull qh_setsize qh_zero _setjmp __sigsetjmp'
fi
imported=$( "$nm" -D --undefined-only "$shared" | awk '{ sub( /@.*/, "", $NF ); print $NF }' | sort -u )
report "imported without a reason in $0" "$( comm -23 <( printf '%s\n' "$imported" ) <( tr -s ' \n' '\n\n' <<<"$allowed" | sort -u ) )"
report "ends the process, or prints" \
	"$( grep -E '^(_?_?exit|_Exit|quick_exit|abort|raise|kill|__assert_fail|perror|err|errx|v?f?printf|v?dprintf|__v?f?printf_chk|f?puts?c?|putchar|putc|fwrite|write|longjmp|_longjmp|__longjmp_chk)$' <<<"$imported" || true )"

# ---- sources of memory: the default allocator alone ----------------------------------------------------------------------
case "$archive" in
*.a) report "takes or gives memory past lw_allocator" \
	"$( "$nm" -A --undefined-only "$archive" 2>/dev/null | awk '$NF ~ /^(malloc|calloc|realloc|aligned_alloc|posix_memalign|memalign|free|strdup|alloca)$/ { split( $1, part, ":" ); print part[2], $NF }' | grep -v '^base\.c\.o ' || true )"
	# Distances, states, edges and kernels are compiled apart from builders: their objects cannot even ask for memory
	report "a question that takes memory" \
		"$( "$nm" -A --undefined-only "$archive" 2>/dev/null | awk '$NF ~ /^(lwi_alloc|lwi_alloc_zero|lwi_free)$/ { split( $1, part, ":" ); print part[2], $NF }' |
			grep -E '^(distance_.*|edge.*|kernels.*|tri_tri|separation|witness_.*|convex|convex_simplex.*|solid_contains|body_point|kinematics|checker_environment|checker_self|checker_pose)\.c\.o ' || true )" ;;
esac

# ---- an installed copy is the same -------------------------------------------------------------------------------------
rm -rf "$prefix"
"$cmake" --install "$build" --prefix "$prefix" >/dev/null
installed=$( find "$prefix" -name "$( basename "$archive" )" -type f )
if [ -z "$installed" ]; then
	report "installed" "no $( basename "$archive" ) in $prefix"
elif [ "${archive##*.}" = a ] && ! cmp -s "$installed" "$archive"; then
	report "installed" "$installed is not the library that was looked at"
fi
rm -rf "$prefix"

if [ "$bad" -eq 0 ]; then
	printf '%s functions exported, %s imports, no writable globals, no executable stack\n' "$( wc -l <<<"$exported" )" "$( wc -l <<<"$imported" )"
fi
exit "$bad"
