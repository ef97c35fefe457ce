#!/usr/bin/env bash
# usage: quick_check.sh DEPLOY_REPORT BUILD REPORT_TABLES OUT
set -euo pipefail
"${1:?}" --quick --no-build --build "${2:?}" --out "${4:?}"
"${3:?}" page "$4"
