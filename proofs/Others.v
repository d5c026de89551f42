(* The Sobczyk laws are bounded; lugre_arctan is passive without damping of the bristles, or with little. *)
From Coq Require Import Reals Lra Psatz.
From Coquelicot Require Import Coquelicot.
From Stribeck Require Import Laws Motion Power Terms Continuous Relaxation Passive Extract Unique.
Open Scope R_scope.

Lemma S_0_range p v : -1 <= S_0 p v <= 1.
Proof.
  unfold S_0. pose proof (atan_bound (k_v p * v)) as A. pose proof PI_RGT_0 as P.
  assert (C : 2 / PI * (PI / 2) = 1) by (field; lra). assert (C0 : 0 < 2 / PI) by (apply Rdiv_lt_0_compat; lra).
  split; nra.
Qed.

Lemma v_S_0_below p v : 0 < k_v p -> v * S_0 p v <= Rabs v.
Proof.
  intros Hk. pose proof (S_0_range p v) as S. apply Rle_trans with (1 := Rle_abs _). rewrite Rabs_mult.
  assert (Rabs (S_0 p v) <= 1) by (apply Rabs_le; lra). pose proof (Rabs_pos v). nra.
Qed.

Lemma beyond_g p z : 0 < sigma_0 p -> 0 < F_c p -> F_c p <= F_s p -> forall v, F_s p / sigma_0 p <= z -> 1 <= / g p v * z.
Proof.
  intros H0 Hc HF v Hz. pose proof (g_range p v H0 HF) as G. pose proof (g_pos p v H0 Hc HF) as P.
  apply Rmult_le_reg_l with (g p v); [exact P|]. rewrite <- Rmult_assoc, Rinv_r; lra.
Qed.

Theorem lugre_sobczyk_bounded p : lugre_sobczyk.allowed p ->
  keeps (U := R_UniformSpace) (lugre_sobczyk.dz_dt p) any (lugre_sobczyk.z_bound p).
Proof.
  intros (H0 & H1 & H2 & Hc & Hs & Hv & Hk & HF) v z a b M _ Hz.
  apply (motion_within (U := R_UniformSpace) (lugre_sobczyk.dz_dt p) any (lugre_sobczyk.z_bound p) v z a b M (fun _ _ => I) Hz);
  intros w x _ Hx; unfold lugre_sobczyk.z_bound, lugre_sobczyk.dz_dt in *; pose proof (S_0_range p w); pose proof (v_S_0_nonneg p w Hk).
  - pose proof (beyond_g p x H0 Hc HF w Hx).
    replace (S_0 p w * S_0 p w * w - w * S_0 p w / g p w * x) with (w * S_0 p w * (S_0 p w - / g p w * x)) by (unfold Rdiv; ring). nra.
  - pose proof (beyond_g p (- x) H0 Hc HF w ltac:(lra)).
    replace (S_0 p w * S_0 p w * w - w * S_0 p w / g p w * x) with (w * S_0 p w * (S_0 p w + / g p w * - x)) by (unfold Rdiv; ring). nra.
Qed.

Theorem elastoplastic_sobczyk_bounded p : elastoplastic_sobczyk.allowed p ->
  keeps (U := R_UniformSpace) (elastoplastic_sobczyk.dz_dt p) any (elastoplastic_sobczyk.z_bound p).
Proof.
  intros (H0 & H1 & H2 & Hc & Hs & Hv & Hb & Hk & HF & Hba) v z a b M _ Hz.
  assert (A : forall w x, F_s p / sigma_0 p <= Rabs x -> alpha_0 p w x = 1).
  { intros w x Hx. assert (B : z_ba p < g p w) by (apply z_ba_below; assumption).
    rewrite alpha_0_is by exact B. apply sine_step_high, yielded_high; [exact B|].
    pose proof (g_range p w H0 HF). lra. }
  pose proof (z_bound_pos p H0 Hs).
  apply (motion_within (U := R_UniformSpace) (elastoplastic_sobczyk.dz_dt p) any (elastoplastic_sobczyk.z_bound p) v z a b M (fun _ _ => I) Hz);
  intros w x _ Hx; unfold elastoplastic_sobczyk.z_bound, elastoplastic_sobczyk.dz_dt in *; pose proof (S_0_range p w);
  pose proof (v_S_0_nonneg p w Hk).
  - pose proof (beyond_g p x H0 Hc HF w Hx). rewrite A by (rewrite Rabs_pos_eq; lra).
    replace (S_0 p w * S_0 p w * w - 1 * (w * S_0 p w) / g p w * x) with (w * S_0 p w * (S_0 p w - / g p w * x)) by (unfold Rdiv; ring). nra.
  - pose proof (beyond_g p (- x) H0 Hc HF w ltac:(lra)). rewrite A by (rewrite Rabs_left; lra).
    replace (S_0 p w * S_0 p w * w - 1 * (w * S_0 p w) / g p w * x) with (w * S_0 p w * (S_0 p w + / g p w * - x)) by (unfold Rdiv; ring). nra.
Qed.

Lemma lugre_arctan_stores p (s1 : R -> R) (F : R -> R -> R) : lugre_arctan.allowed p ->
  (forall v, continuous (T := R_UniformSpace) (U := R_UniformSpace) s1 v) -> (forall v, 0 <= s1 v) ->
  (forall v, s1 v * Rabs v <= 4 * F_c p) ->
  (forall v z, F v z = sigma_0 p * z + s1 v * lugre_arctan.dz_dt p v z + sigma_2 p * v) ->
  storage (U := R_UniformSpace) (lugre_arctan.dz_dt p) any (power_of F) any (lugre_arctan.stored_energy p).
Proof.
  intros (H0 & H1 & H2 & Hc & Hs & Hv & Hk & HF) C1 S1 H4 HFo.
  assert (Cr : continuous_2 (U := R_UniformSpace) (lugre_arctan.dz_dt p)).
  { pose proof (c_lugre_arctan (U := R_UniformSpace) p (fun v => v) (fun _ => F_c p) (fun _ => F_s p)
      (fun w => continuous_id w) (fun w => continuous_const _ w) (fun w => continuous_const _ w) H0 (fun _ => conj Hc HF)) as K.
    simpl in K. rewrite at_own_level in K. exact K. }
  apply storage_by with (fun x => sigma_0 p * x).
  - intros u z a b _ _ _ t _. exact I.
  - apply (c_ext (U := R_UniformSpace)
      (fun v z => (sigma_0 p * z + s1 v * lugre_arctan.dz_dt p v z + sigma_2 p * v) * v)).
    + intros v z. unfold power_of. rewrite HFo. reflexivity.
    + pose proof (c_fst (U := R_UniformSpace) (fun v : R => v) (fun w => continuous_id w)).
      pose proof (c_fst (U := R_UniformSpace) s1 C1). cont.
  - intros x. unfold lugre_arctan.stored_energy. auto_derive; [exact I|field].
  - intros x _. unfold lugre_arctan.stored_energy. pose proof (Rle_0_sqr x) as Q. unfold Rsqr in Q. nra.
  - intros v z _ _. unfold power_of. rewrite HFo. pose proof (g_newtons p v H0 HF) as G.
    set (N := sigma_0 p * g p v) in *. pose proof (v_S_0_nonneg p v Hk) as M0. pose proof (v_S_0_below p v Hk) as M1.
    assert (Q : s1 v * (v * S_0 p v) <= 4 * N).
    { apply Rle_trans with (s1 v * Rabs v); [apply Rmult_le_compat_l; auto|]. specialize (H4 v). lra. }
    pose proof (power_damped (s1 v) (sigma_2 p) N (v * S_0 p v) v (sigma_0 p * z) (S1 v) H2 ltac:(lra) M0 Q) as D.
    assert (E : (sigma_0 p * z + s1 v * lugre_arctan.dz_dt p v z + sigma_2 p * v) * v - sigma_0 p * z * lugre_arctan.dz_dt p v z
      = / N * (N * ((s1 v + sigma_2 p) * (v * v)) + v * S_0 p v * (sigma_0 p * z * (sigma_0 p * z - s1 v * v)))).
    { unfold lugre_arctan.dz_dt, N. field. pose proof (g_pos p v H0 Hc HF). lra. }
    assert (0 <= / N) by (apply Rlt_le, Rinv_0_lt_compat; lra). nra.
Qed.

Theorem lugre_arctan_passive p : lugre_arctan.allowed p -> lugre_arctan.claims_passive p ->
  storage (U := R_UniformSpace) (lugre_arctan.dz_dt p) any (power_of (lugre_arctan.friction p)) any (lugre_arctan.stored_energy p).
Proof.
  intros H C. pose proof H as (H0 & H1 & H2 & Hc & _). unfold lugre_arctan.claims_passive in C.
  apply (lugre_arctan_stores p (fun _ => sigma_1 p)); auto.
  - intros v. apply continuous_const.
  - intros v. assert (E : sigma_1 p = 0) by lra. rewrite E. lra.
Qed.

Theorem lugre_arctan_passive_v_d p : lugre_arctan.allowed_v_d p -> lugre_arctan.claims_passive_v_d p ->
  storage (U := R_UniformSpace) (lugre_arctan.dz_dt p) any (power_of (lugre_arctan.friction_v_d p)) any
    (lugre_arctan.stored_energy p).
Proof.
  intros (H0 & H1 & H2 & Hc & Hs & Hv & Hk & Hd & HF) C. unfold lugre_arctan.claims_passive_v_d in C.
  apply (lugre_arctan_stores p (sigma_1_at p)); auto.
  - repeat split; assumption.
  - intros v. apply sigma_1_at_continuous.
  - intros v. apply sigma_1_at_range. exact H1.
  - intros v. pose proof (sigma_1_at_damped p v 0 H1 Hd (Rle_refl 0)) as D. rewrite !Rplus_0_r in D. lra.
Qed.
