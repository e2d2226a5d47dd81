# Read by tools/build/windows.sh and tools/build/macos.sh in the folder of the crossed libraries: they come from Debian's sources into root/.

# unpack PACKAGE: its source, into a folder of its name
unpack() {
    [ ! -d "$1" ] || return 0
    "$tools/source.sh" "$1" "sources/$1"
    mkdir "$1.new"
    tar -xaf sources/"$1"/*.orig.tar.* -C "$1.new" --strip-components 1
    mv "$1.new" "$1"
}

# cross PACKAGE LIBRARY OPTION...: static, by cmake
cross() {
    package=$1 library=$2
    shift 2
    [ ! -e "root/lib/$library" ] || return 0
    unpack "$package"
    echo "cross $package"
    # expat's is a folder further in
    from=$package
    [ -e "$from/CMakeLists.txt" ] || from=$package/$package
    { cmake -S "$from" -B "$package/cross" -DCMAKE_FIND_ROOT_PATH_MODE_PROGRAM=NEVER -DCMAKE_FIND_ROOT_PATH_MODE_LIBRARY=ONLY \
        -DCMAKE_FIND_ROOT_PATH_MODE_INCLUDE=ONLY -DCMAKE_BUILD_TYPE=Release -DBUILD_SHARED_LIBS=OFF \
        -DCMAKE_INSTALL_PREFIX="$PWD/root" "$@" && cmake --build "$package/cross" -j"$(nproc)" -t install; } \
        >"$package.log" 2>&1 || { tail -n 5 "$PWD/$package.log" >&2; exit 1; }
    rm -r "$package"
    [ -e "root/lib/$library" ] || mv "root/lib/${library%.a}_doubles.a" "root/lib/$library"
}

# cross_libraries OPTION...: ODE without collisions, libsndfile with WAV, AIFF and AU alone, and expat
cross_libraries() {
    cross ode libode.a -DODE_DOUBLE_PRECISION=ON -DODE_WITH_DEMOS=OFF -DODE_WITH_TESTS=OFF -DODE_WITH_LIBCCD=OFF \
        -DODE_WITH_GIMPACT=OFF -DODE_WITH_OPCODE=OFF "$@"
    cross libsndfile libsndfile.a -DBUILD_PROGRAMS=OFF -DBUILD_EXAMPLES=OFF -DBUILD_TESTING=OFF -DENABLE_EXTERNAL_LIBS=OFF \
        -DENABLE_MPEG=OFF "$@"
    cross expat libexpat.a -DEXPAT_BUILD_TOOLS=OFF -DEXPAT_BUILD_EXAMPLES=OFF -DEXPAT_BUILD_TESTS=OFF -DEXPAT_BUILD_DOCS=OFF \
        -DEXPAT_SHARED_LIBS=OFF "$@"
}
