#!/usr/bin/env bash
# Builds Rigproof without the simulator, installs it, and builds and runs a project that finds it by find_package.
# Usage: run.sh SOURCE_FOLDER SCRATCH_FOLDERS (their names begin so)
set -euo pipefail
source_folder=$1
scratch=$2
rm -rf "$scratch-prefix" "$scratch-project"
# The library's build folder lies as deep as that of a preset: relative paths are alike, and ccache knows the objects.
export CCACHE_BASEDIR=$source_folder CCACHE_NOHASHDIR=1 CCACHE_SLOPPINESS=pch_defines,time_macros
cmake -S "$source_folder" -B "$scratch-library" -G Ninja -DCMAKE_BUILD_TYPE=Release -DRIGPROOF_SIMULATOR=OFF \
  -DRIGPROOF_TESTS=OFF -DRIGPROOF_WARNINGS_AS_ERRORS=ON -DCMAKE_CXX_COMPILER_LAUNCHER=ccache \
  -DCMAKE_DISABLE_FIND_PACKAGE_mujoco=ON -DCMAKE_DISABLE_FIND_PACKAGE_OpenGL=ON >/dev/null
cmake --build "$scratch-library"
cmake --install "$scratch-library" --prefix "$scratch-prefix" >/dev/null
cmake -S "$source_folder/tests/consumer" -B "$scratch-project" -G Ninja -DCMAKE_BUILD_TYPE=Release \
  -DCMAKE_PREFIX_PATH="$scratch-prefix" >/dev/null
cmake --build "$scratch-project"
"$scratch-project/consumer"
if ldd "$scratch-project/consumer" | grep -Ei 'mujoco|libEGL'; then
  echo 'the consumer links what it must not need' >&2
  exit 1
fi
