#!/bin/sh
# Builds the library and installs it with its header and its pkg-config file: ./install.sh [PREFIX], by default /usr/local.
set -eu
prefix=${1:-/usr/local}
own=$(CDPATH= cd "$(dirname "$0")" && pwd)
target=${CARGO_TARGET_DIR:-$own/../../target}
mkdir -p "$target"
target=$(CDPATH= cd "$target" && pwd)
(cd "$own" && cargo build --release --quiet --package muslin-c --target-dir "$target")
mkdir -p "$prefix/include" "$prefix/lib/pkgconfig"
cp "$own/include/muslin.h" "$prefix/include/"
for library in libmuslin.a libmuslin.so libmuslin.dylib; do
    if [ -f "$target/release/$library" ]; then cp "$target/release/$library" "$prefix/lib/"; fi
done
[ -f "$prefix/lib/libmuslin.a" ] || { echo "no library was built in $target" >&2; exit 1; }
version=$(sed -n 's/^version = "\(.*\)"/\1/p' "$own/../../Cargo.toml" | head -n 1)
cat > "$prefix/lib/pkgconfig/muslin.pc" <<END
prefix=$(CDPATH= cd "$prefix" && pwd)
Name: muslin
Description: A cloth simulator that says what each method costs and how large its error is
Version: $version
Cflags: -I\${prefix}/include
Libs: -L\${prefix}/lib -lmuslin
Libs.private: -lpthread -ldl -lm
END
