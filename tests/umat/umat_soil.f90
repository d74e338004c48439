! SPDX-License-Identifier: MIT
! Two material routines for the UMAT interface: linear elasticity and elasticity with the yield
! condition of von Mises.

subroutine umat_elastic(stress, statev, ddsdde, sse, spd, scd, rpl, ddsddt, drplde, drpldt, &
    stran, dstran, time, dtime, temp, dtemp, predef, dpred, cmname, ndi, nshr, ntens, nstatv, &
    props, nprops, coords, drot, pnewdt, celent, dfgrd0, dfgrd1, noel, npt, layer, kspt, kstep, &
    kinc)
  implicit none
  character(len=80) :: cmname
  integer :: ndi, nshr, ntens, nstatv, nprops, noel, npt, layer, kspt, kstep, kinc
  double precision :: stress(ntens), statev(nstatv), ddsdde(ntens, ntens), sse, spd, scd, rpl
  double precision :: ddsddt(ntens), drplde(ntens), drpldt, stran(ntens), dstran(ntens), time(2)
  double precision :: dtime, temp, dtemp, predef(1), dpred(1), props(nprops), coords(3)
  double precision :: drot(3, 3), pnewdt, celent, dfgrd0(3, 3), dfgrd1(3, 3)
  double precision :: shear, lame
  integer :: i

  shear = props(1) / (2 * (1 + props(2)))
  lame = 2 * shear * props(2) / (1 - 2 * props(2))
  ddsdde = 0
  ddsdde(1:ndi, 1:ndi) = lame
  do i = 1, ndi
    ddsdde(i, i) = lame + 2 * shear
  end do
  do i = ndi + 1, ntens
    ddsdde(i, i) = shear
  end do
  stress = stress + matmul(ddsdde, dstran)
end subroutine

subroutine umat_von_mises(stress, statev, ddsdde, sse, spd, scd, rpl, ddsddt, drplde, drpldt, &
    stran, dstran, time, dtime, temp, dtemp, predef, dpred, cmname, ndi, nshr, ntens, nstatv, &
    props, nprops, coords, drot, pnewdt, celent, dfgrd0, dfgrd1, noel, npt, layer, kspt, kstep, &
    kinc)
  implicit none
  character(len=80) :: cmname
  integer :: ndi, nshr, ntens, nstatv, nprops, noel, npt, layer, kspt, kstep, kinc
  double precision :: stress(ntens), statev(nstatv), ddsdde(ntens, ntens), sse, spd, scd, rpl
  double precision :: ddsddt(ntens), drplde(ntens), drpldt, stran(ntens), dstran(ntens), time(2)
  double precision :: dtime, temp, dtemp, predef(1), dpred(1), props(nprops), coords(3)
  double precision :: drot(3, 3), pnewdt, celent, dfgrd0(3, 3), dfgrd1(3, 3)
  double precision :: deviator(6), norm, excess, shear

  call umat_elastic(stress, statev, ddsdde, sse, spd, scd, rpl, ddsddt, drplde, drpldt, stran, &
      dstran, time, dtime, temp, dtemp, predef, dpred, cmname, ndi, nshr, ntens, nstatv, props, &
      nprops, coords, drot, pnewdt, celent, dfgrd0, dfgrd1, noel, npt, layer, kspt, kstep, kinc)
  if (cmname(1:4) /= 'CLAY') pnewdt = 0.5d0
  deviator = 0
  deviator(1:ntens) = stress
  deviator(1:3) = stress(1:3) - sum(stress(1:3)) / 3
  norm = sqrt(sum(deviator(1:3)**2) + 2 * sum(deviator(4:6)**2))
  excess = norm - sqrt(2d0) * props(3)
  if (excess <= 0) return
  shear = props(1) / (2 * (1 + props(2)))
  statev(1) = statev(1) + excess / (sqrt(2d0) * shear)
  stress = stress - (excess / norm) * deviator(1:ntens)
end subroutine
