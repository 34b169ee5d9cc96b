// vog/convert.h: conversion of volumes and particles to Gaussians, by every method.
#pragma once

#include "vog/convert_moments.h"
#include "vog/convert_paper.h"
#include "vog/convert_points.h"
