#!/bin/sh
# Makes the tables of the kit `shapes` anew, by `malleus shape` alone:
#
#     sh tables/shapes/make.sh
#
# MALLEUS names another program than the one that cargo builds, TABLES another folder for what is
# written.
set -eu
cd "$(dirname "$0")"
malleus=${MALLEUS:-cargo run --release -q -p malleus --}
tables=${TABLES:-.}

# Bars are cut from their blanks first.
undercut() {
    name=$1
    shift
    $malleus shape "$name.bar.toml" --undercut 1:4:10 --tuned "$tables/$name.shape.toml" \
        -o "$tables/$name.toml" --licence CC0-1.0 --max-hz 20000 "$@"
}

shape() {
    name=$1
    shift
    $malleus shape "$name.shape.toml" -o "$tables/$name.toml" --licence CC0-1.0 "$@"
}

undercut marimba --hz 220
undercut vibraphone --hz 349.23
shape glockenspiel --max-hz 20000
shape woodblock --max-hz 20000
shape drum --modes 40
shape heart-drum --modes 40
shape bell --modes 40
shape gong --modes 48
shape cymbal --modes 60
shape glass --modes 18
shape cowbell --modes 18
