#!/bin/sh
# Installs what is built, or removes exactly that. Called by `make install` and `make uninstall`, which set the names below.
#   BUILD=... DESTDIR=... PREFIX=... LIBDIR=... PDEXTRA=... VERSION=... STRIP=... tools/build/install.sh install|uninstall
set -eu
major=${VERSION%%.*}
share=$PREFIX/share
doc=$share/doc/himc
himc=$BUILD/bin/himc

tab=$(printf '\t')

# a line for all that goes into one folder, whose name may have spaces
entry() { # entry MODE FOLDER FILE...
    line="$1$tab$2$tab"
    shift 2
    echo "$line$*"
}

lists() {
    entry 755 "$PREFIX/bin" "$himc" $(ls "$BUILD/bin/himc-viewer" 2>/dev/null || true)
    entry 644 "$LIBDIR" "$BUILD/libhimc.a" "$BUILD/libhimc.so.$VERSION"
    entry 644 "$LIBDIR/pkgconfig" "$BUILD/himc.pc"
    entry 644 "$PREFIX/include/himc" lib/himc/*.h
    entry 644 "$PDEXTRA/himc" LICENSE LIBRARIES.txt "$BUILD"/externals/himc/* patches/techniques/*
    entry 644 "$PDEXTRA/himc/clips" "$BUILD"/clips/*
    entry 644 "$PDEXTRA/himc/patches" patches/*.pd patches/*.txt
    entry 644 "$PDEXTRA/himc/patches/lib" patches/lib/*
    entry 644 "$PDEXTRA/himc/patches/pieces" patches/pieces/*
    entry 644 "$doc" LICENSE LIBRARIES.txt README.md CHANGELOG.md
    entry 644 "$doc/docs" docs/*.md
    for part in examples figures results sounds; do
        entry 644 "$doc/docs/$part" docs/$part/*
    done
    entry 644 "$share/man/man1" "$BUILD"/share/*.1
    entry 644 "$share/bash-completion/completions" "$BUILD/share/himc"
    entry 644 "$share/zsh/site-functions" "$BUILD/share/_himc"
}

# a link of the documentation to what is not installed becomes its text
drop_dead_links() {
    for page in "$DESTDIR$doc"/*.md "$DESTDIR$doc"/docs/*.md "$DESTDIR$doc"/docs/results/*.md; do
        grep -oE '\]\([^) ]+\)' "$page" | sed 's/^](//; s/)$//' | sort -u | while read -r link; do
            case $link in *://* | mailto:* | "#"*) continue ;; esac
            [ -e "${page%/*}/${link%%#*}" ] && continue
            sed "s|\[\([^]]*\)\]($(echo "$link" | sed 's/[].[*^$|]/\\&/g'))|\1|g" "$page" >"$page.new"
            cat "$page.new" >"$page"
            rm "$page.new"
        done
    done
}

page() { # page CALL COMMAND...: the manual page himc-CALL
    call=$1
    shift
    "$@" --help | awk -v call="$call" -v version="$VERSION" -f tools/build/man.awk >"$BUILD/share/himc${call:+-$call}.1"
}

# manual pages and completions, from what the programs say of themselves
make_pages() {
    calls=$("$himc" --help | sed -n 's/^  \([a-z]*\) .*/\1/p')
    rm -rf "$BUILD/share"
    mkdir -p "$BUILD/share"
    [ ! -x "$himc-viewer" ] || page viewer "$himc-viewer"
    for call in "" $calls; do
        page "$call" "$himc" $call
        echo "== $call"
        "$himc" $call --help
    done >"$BUILD/share/help"
    awk -v shell=bash -f tools/build/completions.awk "$BUILD/share/help" >"$BUILD/share/himc"
    awk -v shell=zsh -f tools/build/completions.awk "$BUILD/share/help" >"$BUILD/share/_himc"
}

install_all() {
    lists | while IFS=$tab read -r mode folder files; do
        install -d "$DESTDIR$folder"
        install -m "$mode" $files "$DESTDIR$folder"
        for file in $files; do
            case $file in */bin/himc* | */libhimc.* | *.pd_*) ${STRIP:-:} -S -x "$DESTDIR$folder/${file##*/}" ;; esac
        done
    done
    drop_dead_links
    # technique~ is beside the objects there
    sed 's|techniques/technique~|technique~|' patches/performance.pd >"$DESTDIR$PDEXTRA/himc/patches/performance.pd"
    ln -sf "libhimc.so.$VERSION" "$DESTDIR$LIBDIR/libhimc.so.$major"
    ln -sf "libhimc.so.$major" "$DESTDIR$LIBDIR/libhimc.so"
}

# folders of ours that are empty then go, too; others' files in them stay
uninstall_all() {
    lists | while IFS=$tab read -r mode folder files; do
        for file in $files; do
            rm -f "$DESTDIR$folder/${file##*/}"
        done
    done
    rm -f "$DESTDIR$LIBDIR/libhimc.so.$major" "$DESTDIR$LIBDIR/libhimc.so"
    lists | while IFS=$tab read -r mode folder files; do
        case $folder in */himc | */himc/*) echo "$folder" ;; esac
    done | sort -r | while read -r folder; do
        rmdir "$DESTDIR$folder" 2>/dev/null || true
    done
}

make_pages
"$1"_all
