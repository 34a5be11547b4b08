# Builds a program as somebody with a makefile does, and runs it: pkg-config.sh COMPILER SOURCE
set -e
"$1" "$2" $(pkg-config --cflags --libs skinslide) -Wl,-rpath,"$(pkg-config --variable=libdir skinslide)" -o consumer_pkg_config
./consumer_pkg_config
