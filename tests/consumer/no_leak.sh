#!/usr/bin/env bash
# The calibration core must never see the truth: nothing that calib is built from includes or links it.
# Usage: no_leak.sh SOURCE_FOLDER
set -euo pipefail
cd "$1"
if grep -rnE '#include .*rigproof/truth|rigproof::truth|rigproof_truth' calib core/src core/include core/formats core/png core/CMakeLists.txt; then
  echo 'these lines let the calibration core see the truth' >&2
  exit 1
fi
