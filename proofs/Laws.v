(* The equations of the laws, as they are simulated. Written by proofs/generate.py: do not edit. *)
From Coq Require Import Reals.
From Coquelicot Require Import Coquelicot.
Open Scope R_scope.

Record constants := { sigma_0 : R; sigma_1 : R; sigma_2 : R; F_c : R; F_s : R; v_s : R; v_d : R; k_v : R; z_ba : R }.

Definition g (p : constants) (v : R) : R :=
  (F_c p + (F_s p - F_c p) * exp (- (v / v_s p * (v / v_s p)))) / sigma_0 p.

Definition sigma_1_at (p : constants) (v : R) : R :=
  sigma_1 p * exp (- (v / v_d p * (v / v_d p))).

Definition S_0 (p : constants) (v : R) : R :=
  (2 / PI) * atan (k_v p * v).

Definition m_atan (p : constants) (v : R) : R :=
  v * S_0 p v + 2 / (PI * k_v p).

Definition m_sqrt (p : constants) (v : R) : R :=
  sqrt (v * v + 1 / k_v p * (1 / k_v p)).

Definition m_compact (p : constants) (v : R) : R :=
  if Rlt_dec (k_v p * Rabs v) 1 then (3 + 6 * (k_v p * v * (k_v p * v)) - k_v p * v * (k_v p * v) * (k_v p * v * (k_v p * v))) / (8 * k_v p)
  else Rabs v.

Definition alpha_0 (p : constants) (v z : R) : R :=
  if Rle_dec (Rabs z) (z_ba p) then 0
  else if Rlt_dec (Rabs z) (g p v) then (1 / 2) + (1 / 2) * sin (PI * (Rabs z - (g p v + z_ba p) / 2) / (g p v - z_ba p))
  else 1.

Definition alpha (p : constants) (v z : R) : R :=
  if Rle_dec (v * z) 0 then 0
  else alpha_0 p v z.

Definition s (p : constants) (v z : R) : R :=
  if Rlt_dec ((Rabs z - z_ba p) / (g p v - z_ba p)) 0 then 0
  else if Rlt_dec 1 ((Rabs z - z_ba p) / (g p v - z_ba p)) then 1
  else (Rabs z - z_ba p) / (g p v - z_ba p).

Definition a (p : constants) (v z : R) : R :=
  s p v z * (s p v z * s p v z) * (10 - 15 * s p v z + 6 * (s p v z * s p v z)).


Module lugre.
Definition dz_dt (p : constants) (v z : R) : R :=
  v - Rabs v / g p v * z.
Definition friction (p : constants) (v z : R) : R :=
  sigma_0 p * z + sigma_1 p * dz_dt p v z + sigma_2 p * v.
Definition stored_energy (p : constants) (z : R) : R :=
  sigma_0 p * (z * z) / 2.
Definition z_bound (p : constants) : R :=
  F_s p / sigma_0 p.
Definition allowed (p : constants) : Prop :=
  0 < sigma_0 p /\ 0 <= sigma_1 p /\ 0 <= sigma_2 p /\ 0 < F_c p /\ 0 < F_s p /\ 0 < v_s p /\ F_c p <= F_s p.
Definition claims_passive (p : constants) : Prop :=
  sigma_1 p * (F_s p - F_c p) <= sigma_2 p * F_c p.
Definition friction_v_d (p : constants) (v z : R) : R :=
  sigma_0 p * z + sigma_1_at p v * dz_dt p v z + sigma_2 p * v.
Definition allowed_v_d (p : constants) : Prop :=
  0 < sigma_0 p /\ 0 <= sigma_1 p /\ 0 <= sigma_2 p /\ 0 < F_c p /\ 0 < F_s p /\ 0 < v_s p /\ 0 < v_d p /\ F_c p <= F_s p.
Definition claims_passive_v_d (p : constants) : Prop :=
  (sigma_1 p * (F_s p - F_c p) <= sigma_2 p * F_c p) \/ (sigma_1 p * (v_d p / (Rpower (2 * (exp 1)) (1 / 2))) <= 4 * F_c p).
End lugre.

Module lugre_arctan.
Definition dz_dt (p : constants) (v z : R) : R :=
  v - v * S_0 p v / g p v * z.
Definition friction (p : constants) (v z : R) : R :=
  sigma_0 p * z + sigma_1 p * dz_dt p v z + sigma_2 p * v.
Definition stored_energy (p : constants) (z : R) : R :=
  sigma_0 p * (z * z) / 2.
Definition z_bound (p : constants) : R :=
  F_s p / sigma_0 p.
Definition allowed (p : constants) : Prop :=
  0 < sigma_0 p /\ 0 <= sigma_1 p /\ 0 <= sigma_2 p /\ 0 < F_c p /\ 0 < F_s p /\ 0 < v_s p /\ 0 < k_v p /\ F_c p <= F_s p.
Definition claims_passive (p : constants) : Prop :=
  sigma_1 p <= 0.
Definition friction_v_d (p : constants) (v z : R) : R :=
  sigma_0 p * z + sigma_1_at p v * dz_dt p v z + sigma_2 p * v.
Definition allowed_v_d (p : constants) : Prop :=
  0 < sigma_0 p /\ 0 <= sigma_1 p /\ 0 <= sigma_2 p /\ 0 < F_c p /\ 0 < F_s p /\ 0 < v_s p /\ 0 < k_v p /\ 0 < v_d p /\ F_c p <= F_s p.
Definition claims_passive_v_d (p : constants) : Prop :=
  sigma_1 p * (v_d p / (Rpower (2 * (exp 1)) (1 / 2))) <= 4 * F_c p.
End lugre_arctan.

Module lugre_sobczyk.
Definition dz_dt (p : constants) (v z : R) : R :=
  S_0 p v * S_0 p v * v - v * S_0 p v / g p v * z.
Definition friction (p : constants) (v z : R) : R :=
  sigma_0 p * z + sigma_1 p * dz_dt p v z + sigma_2 p * v.
Definition stored_energy (p : constants) (z : R) : R :=
  sigma_0 p * (z * z) / 2.
Definition z_bound (p : constants) : R :=
  F_s p / sigma_0 p.
Definition allowed (p : constants) : Prop :=
  0 < sigma_0 p /\ 0 <= sigma_1 p /\ 0 <= sigma_2 p /\ 0 < F_c p /\ 0 < F_s p /\ 0 < v_s p /\ 0 < k_v p /\ F_c p <= F_s p.
Definition friction_v_d (p : constants) (v z : R) : R :=
  sigma_0 p * z + sigma_1_at p v * dz_dt p v z + sigma_2 p * v.
Definition allowed_v_d (p : constants) : Prop :=
  0 < sigma_0 p /\ 0 <= sigma_1 p /\ 0 <= sigma_2 p /\ 0 < F_c p /\ 0 < F_s p /\ 0 < v_s p /\ 0 < k_v p /\ 0 < v_d p /\ F_c p <= F_s p.
End lugre_sobczyk.

Module lugre_majorant.
Definition dz_dt (p : constants) (v z : R) : R :=
  v - m_atan p v / g p v * z.
Definition friction (p : constants) (v z : R) : R :=
  sigma_0 p * z + sigma_1 p * dz_dt p v z + sigma_2 p * v.
Definition stored_energy (p : constants) (z : R) : R :=
  sigma_0 p * (z * z) / 2.
Definition z_bound (p : constants) : R :=
  F_s p / sigma_0 p.
Definition allowed (p : constants) : Prop :=
  0 < sigma_0 p /\ 0 <= sigma_1 p /\ 0 <= sigma_2 p /\ 0 < F_c p /\ 0 < F_s p /\ 0 < v_s p /\ 0 < k_v p /\ F_c p <= F_s p.
Definition claims_passive (p : constants) : Prop :=
  (sigma_1 p * (F_s p - F_c p) <= sigma_2 p * F_c p) /\ (sigma_1 p * (2 / (PI * k_v p)) <= F_s p).
Definition friction_v_d (p : constants) (v z : R) : R :=
  sigma_0 p * z + sigma_1_at p v * dz_dt p v z + sigma_2 p * v.
Definition allowed_v_d (p : constants) : Prop :=
  0 < sigma_0 p /\ 0 <= sigma_1 p /\ 0 <= sigma_2 p /\ 0 < F_c p /\ 0 < F_s p /\ 0 < v_s p /\ 0 < k_v p /\ 0 < v_d p /\ F_c p <= F_s p.
Definition claims_passive_v_d (p : constants) : Prop :=
  ((sigma_1 p * (F_s p - F_c p) <= sigma_2 p * F_c p) /\ (sigma_1 p * (2 / (PI * k_v p)) <= F_s p)) \/ (sigma_1 p * (v_d p / (Rpower (2 * (exp 1)) (1 / 2)) + 2 / (PI * k_v p)) <= 4 * F_c p).
End lugre_majorant.

Module lugre_majorant_sqrt.
Definition dz_dt (p : constants) (v z : R) : R :=
  v - m_sqrt p v / g p v * z.
Definition friction (p : constants) (v z : R) : R :=
  sigma_0 p * z + sigma_1 p * dz_dt p v z + sigma_2 p * v.
Definition stored_energy (p : constants) (z : R) : R :=
  sigma_0 p * (z * z) / 2.
Definition z_bound (p : constants) : R :=
  F_s p / sigma_0 p.
Definition allowed (p : constants) : Prop :=
  0 < sigma_0 p /\ 0 <= sigma_1 p /\ 0 <= sigma_2 p /\ 0 < F_c p /\ 0 < F_s p /\ 0 < v_s p /\ 0 < k_v p /\ F_c p <= F_s p.
Definition claims_passive (p : constants) : Prop :=
  (sigma_1 p * (F_s p - F_c p) <= sigma_2 p * F_c p) /\ (sigma_1 p * (1 / k_v p) <= F_s p).
Definition friction_v_d (p : constants) (v z : R) : R :=
  sigma_0 p * z + sigma_1_at p v * dz_dt p v z + sigma_2 p * v.
Definition allowed_v_d (p : constants) : Prop :=
  0 < sigma_0 p /\ 0 <= sigma_1 p /\ 0 <= sigma_2 p /\ 0 < F_c p /\ 0 < F_s p /\ 0 < v_s p /\ 0 < k_v p /\ 0 < v_d p /\ F_c p <= F_s p.
Definition claims_passive_v_d (p : constants) : Prop :=
  ((sigma_1 p * (F_s p - F_c p) <= sigma_2 p * F_c p) /\ (sigma_1 p * (1 / k_v p) <= F_s p)) \/ (sigma_1 p * (v_d p / (Rpower (2 * (exp 1)) (1 / 2)) + 1 / k_v p) <= 4 * F_c p).
End lugre_majorant_sqrt.

Module lugre_majorant_compact.
Definition dz_dt (p : constants) (v z : R) : R :=
  v - m_compact p v / g p v * z.
Definition friction (p : constants) (v z : R) : R :=
  sigma_0 p * z + sigma_1 p * dz_dt p v z + sigma_2 p * v.
Definition stored_energy (p : constants) (z : R) : R :=
  sigma_0 p * (z * z) / 2.
Definition z_bound (p : constants) : R :=
  F_s p / sigma_0 p.
Definition allowed (p : constants) : Prop :=
  0 < sigma_0 p /\ 0 <= sigma_1 p /\ 0 <= sigma_2 p /\ 0 < F_c p /\ 0 < F_s p /\ 0 < v_s p /\ 0 < k_v p /\ F_c p <= F_s p.
Definition claims_passive (p : constants) : Prop :=
  (sigma_1 p * (F_s p - F_c p) <= sigma_2 p * F_c p) /\ (sigma_1 p * (3 / (8 * k_v p)) <= F_s p).
Definition friction_v_d (p : constants) (v z : R) : R :=
  sigma_0 p * z + sigma_1_at p v * dz_dt p v z + sigma_2 p * v.
Definition allowed_v_d (p : constants) : Prop :=
  0 < sigma_0 p /\ 0 <= sigma_1 p /\ 0 <= sigma_2 p /\ 0 < F_c p /\ 0 < F_s p /\ 0 < v_s p /\ 0 < k_v p /\ 0 < v_d p /\ F_c p <= F_s p.
Definition claims_passive_v_d (p : constants) : Prop :=
  ((sigma_1 p * (F_s p - F_c p) <= sigma_2 p * F_c p) /\ (sigma_1 p * (3 / (8 * k_v p)) <= F_s p)) \/ (sigma_1 p * (v_d p / (Rpower (2 * (exp 1)) (1 / 2)) + 3 / (8 * k_v p)) <= 4 * F_c p).
End lugre_majorant_compact.

Module elastoplastic.
Definition dz_dt (p : constants) (v z : R) : R :=
  v - alpha p v z * Rabs v / g p v * z.
Definition friction (p : constants) (v z : R) : R :=
  sigma_0 p * z + sigma_1 p * dz_dt p v z + sigma_2 p * v.
Definition stored_energy (p : constants) (z : R) : R :=
  sigma_0 p * (z * z) / 2.
Definition z_bound (p : constants) : R :=
  F_s p / sigma_0 p.
Definition z_elastic (p : constants) : R :=
  z_ba p.
Definition allowed (p : constants) : Prop :=
  0 < sigma_0 p /\ 0 <= sigma_1 p /\ 0 <= sigma_2 p /\ 0 < F_c p /\ 0 < F_s p /\ 0 < v_s p /\ 0 < z_ba p /\ F_c p <= F_s p /\ z_ba p * sigma_0 p < F_c p.
Definition claims_passive (p : constants) : Prop :=
  sigma_1 p * (F_s p - F_c p) <= sigma_2 p * F_c p.
Definition friction_v_d (p : constants) (v z : R) : R :=
  sigma_0 p * z + sigma_1_at p v * dz_dt p v z + sigma_2 p * v.
Definition allowed_v_d (p : constants) : Prop :=
  0 < sigma_0 p /\ 0 <= sigma_1 p /\ 0 <= sigma_2 p /\ 0 < F_c p /\ 0 < F_s p /\ 0 < v_s p /\ 0 < z_ba p /\ 0 < v_d p /\ F_c p <= F_s p /\ z_ba p * sigma_0 p < F_c p.
Definition claims_passive_v_d (p : constants) : Prop :=
  (sigma_1 p * (F_s p - F_c p) <= sigma_2 p * F_c p) \/ (sigma_1 p * (v_d p / (Rpower (2 * (exp 1)) (1 / 2))) <= 4 * F_c p).
End elastoplastic.

Module elastoplastic_sobczyk.
Definition dz_dt (p : constants) (v z : R) : R :=
  S_0 p v * S_0 p v * v - alpha_0 p v z * (v * S_0 p v) / g p v * z.
Definition friction (p : constants) (v z : R) : R :=
  sigma_0 p * z + sigma_1 p * dz_dt p v z + sigma_2 p * v.
Definition stored_energy (p : constants) (z : R) : R :=
  sigma_0 p * (z * z) / 2.
Definition z_bound (p : constants) : R :=
  F_s p / sigma_0 p.
Definition allowed (p : constants) : Prop :=
  0 < sigma_0 p /\ 0 <= sigma_1 p /\ 0 <= sigma_2 p /\ 0 < F_c p /\ 0 < F_s p /\ 0 < v_s p /\ 0 < z_ba p /\ 0 < k_v p /\ F_c p <= F_s p /\ z_ba p * sigma_0 p < F_c p.
Definition friction_v_d (p : constants) (v z : R) : R :=
  sigma_0 p * z + sigma_1_at p v * dz_dt p v z + sigma_2 p * v.
Definition allowed_v_d (p : constants) : Prop :=
  0 < sigma_0 p /\ 0 <= sigma_1 p /\ 0 <= sigma_2 p /\ 0 < F_c p /\ 0 < F_s p /\ 0 < v_s p /\ 0 < z_ba p /\ 0 < k_v p /\ 0 < v_d p /\ F_c p <= F_s p /\ z_ba p * sigma_0 p < F_c p.
End elastoplastic_sobczyk.

Module elastoplastic_majorant.
Definition dz_dt (p : constants) (v z : R) : R :=
  v - a p v z * m_atan p v / g p v * z.
Definition friction (p : constants) (v z : R) : R :=
  sigma_0 p * z + sigma_1 p * dz_dt p v z + sigma_2 p * v.
Definition stored_energy (p : constants) (z : R) : R :=
  sigma_0 p * (z * z) / 2.
Definition z_bound (p : constants) : R :=
  F_s p / sigma_0 p.
Definition z_elastic (p : constants) : R :=
  z_ba p.
Definition allowed (p : constants) : Prop :=
  0 < sigma_0 p /\ 0 <= sigma_1 p /\ 0 <= sigma_2 p /\ 0 < F_c p /\ 0 < F_s p /\ 0 < v_s p /\ 0 < z_ba p /\ 0 < k_v p /\ F_c p <= F_s p /\ z_ba p * sigma_0 p < F_c p.
Definition claims_passive (p : constants) : Prop :=
  (sigma_1 p * (F_s p - F_c p) <= sigma_2 p * F_c p) /\ (sigma_1 p * (2 / (PI * k_v p)) <= F_s p).
Definition friction_v_d (p : constants) (v z : R) : R :=
  sigma_0 p * z + sigma_1_at p v * dz_dt p v z + sigma_2 p * v.
Definition allowed_v_d (p : constants) : Prop :=
  0 < sigma_0 p /\ 0 <= sigma_1 p /\ 0 <= sigma_2 p /\ 0 < F_c p /\ 0 < F_s p /\ 0 < v_s p /\ 0 < z_ba p /\ 0 < k_v p /\ 0 < v_d p /\ F_c p <= F_s p /\ z_ba p * sigma_0 p < F_c p.
Definition claims_passive_v_d (p : constants) : Prop :=
  ((sigma_1 p * (F_s p - F_c p) <= sigma_2 p * F_c p) /\ (sigma_1 p * (2 / (PI * k_v p)) <= F_s p)) \/ (sigma_1 p * (v_d p / (Rpower (2 * (exp 1)) (1 / 2)) + 2 / (PI * k_v p)) <= 4 * F_c p).
End elastoplastic_majorant.

Module elastoplastic_majorant_sqrt.
Definition dz_dt (p : constants) (v z : R) : R :=
  v - a p v z * m_sqrt p v / g p v * z.
Definition friction (p : constants) (v z : R) : R :=
  sigma_0 p * z + sigma_1 p * dz_dt p v z + sigma_2 p * v.
Definition stored_energy (p : constants) (z : R) : R :=
  sigma_0 p * (z * z) / 2.
Definition z_bound (p : constants) : R :=
  F_s p / sigma_0 p.
Definition z_elastic (p : constants) : R :=
  z_ba p.
Definition allowed (p : constants) : Prop :=
  0 < sigma_0 p /\ 0 <= sigma_1 p /\ 0 <= sigma_2 p /\ 0 < F_c p /\ 0 < F_s p /\ 0 < v_s p /\ 0 < z_ba p /\ 0 < k_v p /\ F_c p <= F_s p /\ z_ba p * sigma_0 p < F_c p.
Definition claims_passive (p : constants) : Prop :=
  (sigma_1 p * (F_s p - F_c p) <= sigma_2 p * F_c p) /\ (sigma_1 p * (1 / k_v p) <= F_s p).
Definition friction_v_d (p : constants) (v z : R) : R :=
  sigma_0 p * z + sigma_1_at p v * dz_dt p v z + sigma_2 p * v.
Definition allowed_v_d (p : constants) : Prop :=
  0 < sigma_0 p /\ 0 <= sigma_1 p /\ 0 <= sigma_2 p /\ 0 < F_c p /\ 0 < F_s p /\ 0 < v_s p /\ 0 < z_ba p /\ 0 < k_v p /\ 0 < v_d p /\ F_c p <= F_s p /\ z_ba p * sigma_0 p < F_c p.
Definition claims_passive_v_d (p : constants) : Prop :=
  ((sigma_1 p * (F_s p - F_c p) <= sigma_2 p * F_c p) /\ (sigma_1 p * (1 / k_v p) <= F_s p)) \/ (sigma_1 p * (v_d p / (Rpower (2 * (exp 1)) (1 / 2)) + 1 / k_v p) <= 4 * F_c p).
End elastoplastic_majorant_sqrt.

Module elastoplastic_majorant_compact.
Definition dz_dt (p : constants) (v z : R) : R :=
  v - a p v z * m_compact p v / g p v * z.
Definition friction (p : constants) (v z : R) : R :=
  sigma_0 p * z + sigma_1 p * dz_dt p v z + sigma_2 p * v.
Definition stored_energy (p : constants) (z : R) : R :=
  sigma_0 p * (z * z) / 2.
Definition z_bound (p : constants) : R :=
  F_s p / sigma_0 p.
Definition z_elastic (p : constants) : R :=
  z_ba p.
Definition allowed (p : constants) : Prop :=
  0 < sigma_0 p /\ 0 <= sigma_1 p /\ 0 <= sigma_2 p /\ 0 < F_c p /\ 0 < F_s p /\ 0 < v_s p /\ 0 < z_ba p /\ 0 < k_v p /\ F_c p <= F_s p /\ z_ba p * sigma_0 p < F_c p.
Definition claims_passive (p : constants) : Prop :=
  (sigma_1 p * (F_s p - F_c p) <= sigma_2 p * F_c p) /\ (sigma_1 p * (3 / (8 * k_v p)) <= F_s p).
Definition friction_v_d (p : constants) (v z : R) : R :=
  sigma_0 p * z + sigma_1_at p v * dz_dt p v z + sigma_2 p * v.
Definition allowed_v_d (p : constants) : Prop :=
  0 < sigma_0 p /\ 0 <= sigma_1 p /\ 0 <= sigma_2 p /\ 0 < F_c p /\ 0 < F_s p /\ 0 < v_s p /\ 0 < z_ba p /\ 0 < k_v p /\ 0 < v_d p /\ F_c p <= F_s p /\ z_ba p * sigma_0 p < F_c p.
Definition claims_passive_v_d (p : constants) : Prop :=
  ((sigma_1 p * (F_s p - F_c p) <= sigma_2 p * F_c p) /\ (sigma_1 p * (3 / (8 * k_v p)) <= F_s p)) \/ (sigma_1 p * (v_d p / (Rpower (2 * (exp 1)) (1 / 2)) + 3 / (8 * k_v p)) <= 4 * F_c p).
End elastoplastic_majorant_compact.

Module dahl.
Definition dz_dt (p : constants) (v z : R) : R :=
  v - sigma_0 p / F_c p * Rabs v * z.
Definition friction (p : constants) (v z : R) : R :=
  sigma_0 p * z.
Definition stored_energy (p : constants) (z : R) : R :=
  sigma_0 p * (z * z) / 2.
Definition z_bound (p : constants) : R :=
  F_c p / sigma_0 p.
Definition allowed (p : constants) : Prop :=
  0 < sigma_0 p /\ 0 < F_c p.
End dahl.
